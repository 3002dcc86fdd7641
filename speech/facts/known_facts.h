// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "memory/memory.h"
#include "speech/facts/known_world.h"
#include "speech/facts/records.h"

namespace engram::speech {

class FactsReader;

/// Where the robot was.
struct RobotState {
  ltm::MemoryId id;
  Time time{};
  Spot spot;
};

/// What a memory tells about what the robot did, heard, meant to do and perceived.
///
/// It finds out by the members of values what each provider segment tells of, and keeps an index of
/// what is rare: executions, words, plans, refusals, drives. What is frequent, as things at 5 Hz
/// and the platform at 100 Hz, is read when it is asked for, and only as much as is asked for. No
/// name of a thing, a place or a skill is known here before a memory tells it.
///
/// Owns: nothing of the memory, which must outlive it.
/// Threading: one thread.
/// Source: docs/verbalisation.md.
class KnownFacts {
 public:
  /// Reads what `memory` has now.
  /// Errors: those of Memory::query, but not that there is nothing.
  static Result<std::unique_ptr<KnownFacts>> read(Memory& memory);

  KnownFacts(const KnownFacts&) = delete;
  KnownFacts& operator=(const KnownFacts&) = delete;
  ~KnownFacts();

  /// Takes up what the memory was told since.
  /// Errors: those of read().
  Status refresh();

  /// The times of the first record and of the last snapshot; equal in an empty memory.
  [[nodiscard]] Time first_moment() const;
  [[nodiscard]] Time last_moment() const;

  [[nodiscard]] const KnownWorld& world() const;
  /// In the order of their starts; each list below in the order of time.
  [[nodiscard]] const std::vector<Execution>& executions() const;
  [[nodiscard]] const std::vector<SpokenWords>& words() const;
  [[nodiscard]] const std::vector<TaskPlan>& plans() const;
  [[nodiscard]] const std::vector<RefusedRequest>& refusals() const;
  [[nodiscard]] const std::vector<DriveNote>& drives() const;
  /// The skills that were executed, refused or planned, without their providers; sorted.
  [[nodiscard]] const std::vector<std::string>& skills() const;

  /// Null where there is none at this ID.
  [[nodiscard]] const TaskPlan* plan_at(const ltm::MemoryId& id) const;
  [[nodiscard]] const SpokenWords* words_at(const ltm::MemoryId& id) const;

  /// The value of an instance; of a snapshot that of its first instance.
  /// Errors: kNotFound where the memory does not have it; those of Memory::query.
  Result<idf::Data> value_at(const ltm::MemoryId& id);

  /// What links say about why there was an execution: from the request over what caused it, in this
  /// order, each with what the value says of itself. At most 16 steps.
  struct Cause {
    ltm::MemoryId id;
    std::string says;
    std::string speaker;  ///< Of words.
  };
  ///
  /// Complexity: a query per link; of what has ended only once.
  Result<std::vector<Cause>> causes_of(const Execution& execution);

  /// How a thing was at `time`, by its last snapshot up to then; nothing where there is none.
  Result<std::optional<ThingState>> thing_at(const ltm::MemoryId& entity, Time time);
  /// The same of all things, in the order of their entities.
  Result<std::vector<ThingState>> things_at(Time time);

  /// The last state of a thing from `from` to `to` that `fits`; read backwards, at most
  /// kMaxStatesRead snapshots. The first one is read forwards.
  using StateTest = std::function<bool(const ThingState&)>;
  Result<std::optional<ThingState>> last_state(const ltm::MemoryId& entity, Time from, Time to,
                                               const StateTest& fits);
  Result<std::optional<ThingState>> first_state(const ltm::MemoryId& entity, Time from, Time to,
                                                const StateTest& fits);
  static constexpr size_t kMaxStatesRead = 30'000;

  /// Where the robot was at `time`, by the last snapshot up to then; nothing where there is none.
  Result<std::optional<RobotState>> robot_at(Time time);
  /// How far the robot drove from `from` to `to`, along its way, and the snapshots at both ends.
  struct Way {
    double length_m = 0;
    std::vector<ltm::MemoryId> ends;
  };
  Result<std::optional<Way>> way_of_robot(Time from, Time to);

 private:
  explicit KnownFacts(std::unique_ptr<FactsReader> reader);

  Result<std::vector<Cause>> read_causes(const Execution& execution);

  static constexpr size_t kMaxWays = 10'000;
  static constexpr size_t kMaxCauseLists = 20'000;

  std::unique_ptr<FactsReader> reader_;
  std::map<std::pair<Time, Time>, Way> ways_;                ///< That were asked for.
  std::map<ltm::MemoryId, std::vector<Cause>> cause_lists_;  ///< By the start of the execution.
};

}  // namespace engram::speech
