// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_set>
#include <vector>

#include "server/skills/condition_state.h"
#include "server/skills/provider_link.h"
#include "server/skills/skill_description.h"
#include "server/skills/skill_records.h"
#include "server/skills/watched_entities.h"

namespace engram::skills {

/// What the skill memory has done since it started.
struct SkillCounters {
  uint64_t requests = 0;  ///< That asked to run a skill, those of conditions included.
  uint64_t started = 0;
  uint64_t ended = 0;  ///< Of these, those with each outcome below.
  uint64_t succeeded = 0;
  uint64_t failed = 0;
  uint64_t stopped = 0;
  uint64_t lost = 0;
  uint64_t refused = 0;
  uint64_t running = 0;  ///< Now.
  uint64_t waiting = 0;  ///< Requests that wait for conditions or resources, now.
};

/// Decides which skill starts, when it is stopped, and what is written of it.
///
/// Every start is written before the provider is told, and every end once. What a provider says
/// of an execution that has ended is ignored.
/// Threading: one thread.
/// Source: docs/skills.md.
class SkillEngine {
 public:
  /// All of them must outlive it.
  SkillEngine(SkillRecords& records, WatchedEntities& watched, Clock clock,
              std::optional<Time> carries_out_since);

  /// Reads what is known, and ends what ran when the memory was last closed.
  /// Errors: those of the memory.
  Status recover();

  /// `link` is dropped once the provider is gone.
  void connect(uint64_t session, std::shared_ptr<ProviderLink> link, const ProviderHello& hello);
  void change(uint64_t session, const ProviderChange& change);
  void disconnect(uint64_t session);
  void report(uint64_t session, const SkillReport& report);

  void on_snapshot(const ltm::Snapshot& snapshot);
  /// Looks for requests that were missed.
  void on_gap();
  /// Does what is due now.
  void on_time();
  /// When on_time() is to be called; nothing if nothing waits for a time.
  [[nodiscard]] std::optional<Time> next_time() const;

  /// Stops everything that runs, and takes no more. Once is_idle(), or after a while, lose_all()
  /// ends the rest.
  void shut_down();
  [[nodiscard]] bool is_idle() const { return executions_.empty(); }
  void lose_all(const std::string& reason);

  [[nodiscard]] SkillCounters counters() const;

 private:
  struct Provider {
    uint64_t session = 0;
    std::shared_ptr<ProviderLink> link;
  };
  struct KnownSkill {
    SkillDescription description;
    ltm::MemoryId executable;  ///< The instance that describes it.
    bool is_prior = false;     ///< Nobody has provided it since it was known.
    bool is_enabled = true;
    bool is_available = false;
    std::optional<ConditionState> when;
    std::vector<std::string> watched;
    bool was_met = false;
    std::vector<Time> running;  ///< When executions of it started.
  };
  /// A request that may start now or later.
  struct Attempt {
    SkillName name;
    ltm::MemoryId request;
    idf::Data parameters;
    std::optional<ConditionState> pre;
    std::optional<ConditionState> hold;
    std::optional<ConditionState> post;
    std::vector<std::string> watched;
    std::vector<std::string> resources;
    Time until{};  ///< Until when it may wait.
  };
  struct Execution {
    Attempt attempt;
    ltm::MemoryId executable;
    std::string parameters_json;
    std::vector<ltm::MemoryId> inputs;
    Time started{};
    uint64_t session = 0;
    std::optional<Time> times_out;
    std::optional<Time> stops_until;  ///< Set once it was told to stop.
    bool is_late = false;             ///< It was told to stop because it took too long.
    std::string stop_reason;
    std::vector<ltm::MemoryId> stopped_by;
    /// The end that it waits with until its condition afterwards is met, and until when.
    std::optional<SkillReport> end;
    Time ends_until{};
  };
  using Executions = std::map<std::string, Execution>;  ///< By the ID of their start.

  [[nodiscard]] Time now() const { return clock_(); }

  // skill_engine_skills.cpp: which skills there are.
  Status recover_skills();
  Status recover_executions();
  Status recover_requests();
  Status take_skill(const SkillName& name, SkillDescription description, bool is_prior);
  Status introduce(const ProviderHello& hello);
  Status remove(const std::string& provider, const std::vector<std::string>& skills);
  void write_executable(const SkillName& name, KnownSkill& skill);
  /// Nobody carries out the skills of this provider any more.
  void take_away(const std::string& provider);
  void set_enabled(const SkillName& name, bool is_enabled);
  [[nodiscard]] Result<SkillName> find(const std::string& text) const;

  // skill_engine_requests.cpp: who wants what.
  void on_request(const ltm::Snapshot& snapshot);
  void request_run(const SkillName& name, const ltm::MemoryId& request,
                   const ::skill::ExecutionRequest& wanted);
  void request_stop(const SkillName& name, const ltm::MemoryId& request,
                    const ::skill::ExecutionRequest& wanted);
  Result<Attempt> prepare(const SkillName& name, const ltm::MemoryId& request,
                          const ::skill::ExecutionRequest& wanted);
  Status prepare_conditions(const SkillDescription& skill, Attempt& attempt);
  Status seed(ConditionState& state);
  /// Whether it started. If not, `why` says why.
  bool try_start(Attempt& attempt, ::skill::Refusal& why);
  void start(Attempt attempt);
  void refuse(const SkillName& name, const ltm::MemoryId& request, ::skill::Refusal refusal);
  void refuse(const SkillName& name, const ltm::MemoryId& request, const std::string& reason);
  /// False if it was answered before.
  bool mark_answered(const ltm::MemoryId& request);
  void look_at_attempts();
  void on_condition(const SkillName& name, KnownSkill& skill);

  // skill_engine_executions.cpp: what runs.
  void check_holds(Execution& execution, const std::string& id);
  void tell_to_stop(const std::string& id, Execution& execution, const std::string& reason,
                    std::vector<ltm::MemoryId> stopped_by);
  void finish(Executions::iterator execution, ::skill::Outcome outcome, const std::string& reason,
              const SkillReport& last);
  void conclude(Executions::iterator execution);
  /// Ends what nobody carries out any more; what its provider had ended already ends as it said.
  void lose(Executions::iterator execution, const std::string& reason);
  void give_up_start(Execution& execution, const Status& status);
  [[nodiscard]] ::skill::Event event_of(const Execution& execution) const;
  /// Writes an end, now or as soon as the memory takes it.
  void write_end(const SkillName& name, const ::skill::Event& event);
  void write_late_ends();

  SkillRecords& records_;
  WatchedEntities& watched_;
  const Clock clock_;
  const std::optional<Time> carries_out_since_;  ///< See SkillMemory::Options.
  std::map<std::string, Provider> providers_;
  std::map<SkillName, KnownSkill> skills_;
  std::vector<Attempt> attempts_;
  Executions executions_;
  /// Ends that could not be written yet, in their order.
  std::deque<std::pair<SkillName, ::skill::Event>> late_ends_;
  Time late_again_{};
  /// Requests that were dealt with; the oldest are dropped beyond a bound.
  std::unordered_set<std::string> answered_;
  std::deque<std::string> answered_order_;
  SkillCounters counters_;
  bool is_recovered_ = false;
  bool is_closing_ = false;
};

}  // namespace engram::skills
