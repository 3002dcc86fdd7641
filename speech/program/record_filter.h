// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: which records the filters of a program keep.

#include <functional>

#include "speech/facts/facts_as_of.h"
#include "speech/program/period.h"
#include "speech/program/program.h"

namespace engram::speech {

/// The filters of a program, with names resolved by what a memory knows.
///
/// Threading: one thread.
class RecordFilter {
 public:
  /// The time of a nested program; nothing where it is unknown.
  using InnerTime = std::function<Result<std::optional<Time>>(const Program&)>;

  /// Errors: kInvalidArgument where a time cannot be read; those of `inner`.
  static Result<RecordFilter> create(const Program& program, FactsAsOf& facts, DayZone zone,
                                     const InnerTime& inner);

  /// Why no record can be kept, as a clause; empty: there is no such reason.
  [[nodiscard]] const std::string& missing() const { return missing_; }

  /// Errors: those of Memory::query, where links must be followed.
  Result<bool> keeps(const Execution& execution);
  [[nodiscard]] bool keeps(const SpokenWords& words) const;
  [[nodiscard]] bool keeps(const TaskPlan& plan) const;
  [[nodiscard]] bool keeps(const RefusedRequest& refusal) const;
  [[nodiscard]] bool keeps(const DriveNote& note) const;

  /// How much an execution that is not kept has to do with what is asked about: its thing most,
  /// then its skill, then its place; 0: nothing.
  [[nodiscard]] int relation(const Execution& execution) const;

  [[nodiscard]] const std::vector<ltm::MemoryId>& things() const { return things_; }
  [[nodiscard]] const std::vector<ltm::MemoryId>& places() const { return places_; }
  [[nodiscard]] bool has_things() const { return has_things_; }
  [[nodiscard]] bool has_places() const { return has_places_; }
  [[nodiscard]] const std::string& hand() const { return hand_; }
  [[nodiscard]] bool asks_running() const { return outcome_ == "running"; }
  [[nodiscard]] const std::optional<bool>& is_held() const { return is_held_; }
  [[nodiscard]] const std::optional<bool>& is_visible() const { return is_visible_; }
  /// When the records must have begun, and the time at which they must go on.
  [[nodiscard]] const Period& begun() const { return begun_; }
  [[nodiscard]] const std::optional<Period>& at() const { return at_; }

 private:
  explicit RecordFilter(FactsAsOf& facts) : facts_(&facts) { begun_.to = facts.now(); }

  void take_names(const Program& program);
  void take_name(FilterKey key, const std::string& text);
  void take_entities(const std::string& text, bool is_thing);
  Status check_hand();
  Status take_times(const Program& program, DayZone zone, const InnerTime& inner);
  [[nodiscard]] bool is_begun(Time time) const;
  [[nodiscard]] bool is_said_at(Time time) const;
  [[nodiscard]] bool has_entity(const std::optional<ltm::MemoryId>& entity, bool is_thing) const;
  [[nodiscard]] bool has_skill(const std::string& provider, const std::string& skill) const;
  [[nodiscard]] bool has_text(const std::string& text) const;
  [[nodiscard]] bool is_speaker(const std::string& speaker) const;
  [[nodiscard]] bool has_outcome(const Execution& execution) const;

  FactsAsOf* facts_;
  std::string missing_;
  std::vector<ltm::MemoryId> things_;
  std::vector<ltm::MemoryId> places_;
  bool has_things_ = false;
  bool has_places_ = false;
  std::vector<std::string> skills_;
  std::string hand_;
  std::string outcome_;
  std::vector<std::string> speakers_;
  std::string text_;
  std::string kind_;
  std::optional<bool> is_held_;
  std::optional<bool> is_visible_;
  Period begun_;
  std::optional<Period> at_;
  std::optional<Period> said_at_;  ///< at_ for what is said at a moment.
};

/// Whose words caused an execution; empty: nobody's that the memory knows.
Result<std::string> speaker_of(FactsAsOf& facts, const Execution& execution);
/// Those words; nothing where there are none.
Result<std::optional<SpokenWords>> words_of(FactsAsOf& facts, const Execution& execution);

}  // namespace engram::speech
