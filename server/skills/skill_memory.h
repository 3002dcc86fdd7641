// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "memory/memory.h"
#include "server/skills/provider_link.h"
#include "server/skills/skill_engine.h"

namespace engram::skills {

/// The memory of skills: what the robot's programs can do, who asked for it, what became of it and
/// why something was not done.
///
/// It listens to the memory for requests and for what conditions look at, tells providers what to
/// execute, and writes each start, report, end and refusal.
/// Owns: a thread.
/// Threading: thread-safe.
/// Source: docs/skills.md.
class SkillMemory {
 public:
  struct Options {
    /// The durability of what is written; kMemory where the memory has no store.
    CommitDurability durability = CommitDurability::kJournal;
    /// The entity whose snapshots tell the time, of a robot that is simulated in steps. Empty: the
    /// clock of the operating system.
    std::optional<ltm::MemoryId> clock{};
    /// Requests since then are carried out when it starts, if nobody has answered them; older ones
    /// are refused. Empty: all are refused.
    std::optional<Time> carries_out_since{};
    /// How long executions have to end when it is closed.
    Duration closes_within = std::chrono::seconds(2);
  };

  /// Declares the types of the memory `Skill`, and ends what ran when it was last closed. `memory`
  /// must outlive it, and must accept commits.
  /// Errors: those of Memory::declare, query and subscribe.
  static Result<std::unique_ptr<SkillMemory>> start(Memory& memory, const Options& options);
  /// Calls close().
  ~SkillMemory();

  /// A provider has come. `link` is told what to execute, by the thread of this memory.
  /// Returns what the provider is called in the other calls.
  uint64_t connect(std::shared_ptr<ProviderLink> link, const ProviderHello& hello);
  /// What a provider has besides, or no longer.
  void change(uint64_t session, const ProviderChange& change);
  /// What a provider says of an execution.
  void report(uint64_t session, const SkillReport& report);
  /// A provider is gone. What runs of it is lost.
  void disconnect(uint64_t session);

  /// Stops what runs, and takes no more requests.
  void close();

  [[nodiscard]] SkillCounters counters() const;

 private:
  struct State;
  explicit SkillMemory(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::skills
