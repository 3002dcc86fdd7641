// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: one execution of a program.

#include "speech/facts/facts_as_of.h"
#include "speech/program/execute.h"
#include "speech/program/record_filter.h"

namespace engram::speech {

/// How near the robot must be to a place to be there.
inline constexpr double kAtPlace_m = 1.5;

/// Carries out a program that validates.
///
/// Threading: one thread.
class ProgramRun {
 public:
  ProgramRun(const Program& program, FactsAsOf& facts, DayZone zone)
      : program_(program), facts_(facts), now_(facts.now()), zone_(zone) {
    outcome_.program = program;
    outcome_.now = now_;
  }

  /// Errors: those of execute().
  Result<Outcome> run();

 private:
  // The records that the filters keep (program_run.cpp).
  Status collect(RecordFilter& filter);
  Status collect_things(RecordFilter& filter);
  Status collect_robot(const RecordFilter& filter);
  Status look_at_things(const RecordFilter& filter, Time at);
  Status apply(const ProgramStep& step, const RecordFilter& filter);
  Status compare(const ProgramStep& step);
  Result<std::optional<Time>> inner_time(const Program& program);

  // Steps on any records (record_steps.cpp).
  bool select(const ProgramStep& step);
  Status count_or_exists(StepKind kind, const RecordFilter& filter);
  void tell_when();
  Status tell_who();
  void tell_which(const std::string& what);
  void tell_how_many(const std::string& what);
  Status tell_said();

  // Steps on no record at all (nothing_steps.cpp).
  Status drop_forgotten(Period at);
  Status tell_nothing(const ProgramStep& step, const RecordFilter& filter);
  Status show_nothing(const RecordFilter& filter);
  Status show_no_thing(const RecordFilter& filter);
  Status cite_things_asked_about(const RecordFilter& filter, Time at);
  void cite_related(const RecordFilter& filter, Period period);
  void cite_around(Period period);
  Result<std::vector<ltm::MemoryId>> records_of(Period period);

  // Steps on executions (execution_steps.cpp, plan_steps.cpp).
  Status apply_to_executions(const ProgramStep& step);
  void choose_by_length(bool is_longest);
  void tell_events();
  void tell_ended();
  void tell_succeeded();
  void tell_span();
  void tell_how_long();
  Status tell_how_far();
  void tell_where_executed();
  Status tell_from();
  Status tell_why();
  void tell_reason();
  void tell_who_stopped();
  void tell_retried();
  void tell_instead(const ProgramStep& step);
  void go_to_neighbour(int by);

  // Steps on things and the robot (thing_steps.cpp).
  Status apply_to_things(const ProgramStep& step, const RecordFilter& filter);
  Status seek_seen(bool is_last, const RecordFilter& filter);
  void tell_where_things();
  void tell_where_robot();
  void tell_is_at(StepKind kind, const RecordFilter& filter);
  void tell_holder();
  void tell_visible(const RecordFilter& filter);
  Status tell_moved(const RecordFilter& filter);
  void tell_moved_by_deeds(const std::vector<ThingState>& things);
  [[nodiscard]] bool is_in_sight(const ThingState& state, const RecordFilter& filter) const;
  /// The moment that is asked about, now where none is.
  [[nodiscard]] Time moment_of(const RecordFilter& filter) const;
  [[nodiscard]] bool has_span() const { return program_.find(FilterKey::kDuring) != nullptr; }

  /// Says that the answer is unknown, and why.
  void miss(std::string why);
  [[nodiscard]] bool is_missed() const { return !outcome_.missing.empty(); }
  /// The number of records that are left.
  [[nodiscard]] size_t size() const;

  const Program& program_;
  FactsAsOf& facts_;
  const Time now_;
  const DayZone zone_;
  Outcome outcome_;
  std::vector<RefusedRequest> refusals_;
  std::vector<DriveNote> drives_;
  std::optional<RobotState> robot_;
  std::vector<ThingState> looked_at_;  ///< Among which the filters chose.
  bool is_place_untold_ = false;       ///< Of one of them.
};

}  // namespace engram::speech
