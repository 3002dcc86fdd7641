// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/memory/memory_id.h"
#include "memory/memory.h"
#include "server/skills/provider_link.h"

namespace engram {

using skills::SkillOutcome;

/// How an execution ended.
struct SkillEnd {
  SkillOutcome outcome = SkillOutcome::kSuccess;
  std::string reason{};                ///< What was measured, in words.
  idf::Data result{idf::Dict()};       ///< What came out, for programs.
  std::vector<ltm::MemoryId> links{};  ///< What it made or found in the memory.

  static SkillEnd success(std::string reason = {}) {
    return {SkillOutcome::kSuccess, std::move(reason)};
  }
  static SkillEnd failure(std::string reason) {
    return {SkillOutcome::kFailure, std::move(reason)};
  }
  static SkillEnd stopped(std::string reason = {}) {
    return {SkillOutcome::kStop, std::move(reason)};
  }
};

/// One execution of a skill, for the function that carries it out.
///
/// Threading: thread-safe.
class SkillRun {
 public:
  virtual ~SkillRun() = default;

  /// All parameters, as the description says: those that were not given have their defaults.
  [[nodiscard]] virtual const idf::Data& parameters() const = 0;
  /// Requested when somebody or something stops it, or the server is gone. The function then ends
  /// soon, with kStop.
  [[nodiscard]] virtual std::stop_token stop() const = 0;
  /// Why it is to stop; empty: it is not.
  [[nodiscard]] virtual std::string stop_reason() const = 0;
  /// The event at which it started, and the request, for links in what it commits.
  [[nodiscard]] virtual const ltm::MemoryId& execution() const = 0;
  [[nodiscard]] virtual const ltm::MemoryId& request() const = 0;

  /// Reports something on the way.
  /// Errors: kUnavailable if the server is gone.
  virtual Status report(const idf::Data& data, const std::vector<ltm::MemoryId>& links = {}) = 0;
};

/// Carries out a skill. It is called in a thread of its own for each execution. An exception counts
/// as a failure.
using SkillFunction = std::function<SkillEnd(SkillRun& run)>;

/// A program that has skills, for the memory that starts them.
///
///     ENGRAM_ASSIGN_OR_RETURN(auto provider, SkillProvider::connect("", "arm"));
///     ENGRAM_RETURN_IF_ERROR(provider->add("name: wave\ntimeout: 5s", [](SkillRun& run) {
///       return SkillEnd::success("waved");
///     }));
///
/// It connects again by itself when the server was gone; what ran then is stopped.
/// Owns: threads of the executions, and one that keeps it connected.
/// Threading: thread-safe. Its destructor stops what runs and waits for it.
/// Source: docs/skills.md.
class SkillProvider {
 public:
  /// Connects to the server that has the memory `Skill`, under the provider's own name. An
  /// `endpoint` as for Memory::connect.
  /// Errors: those of Memory::connect; kAlreadyExists if another provider has this name;
  /// kFailedPrecondition if the server has no skill memory; kUnavailable if there was no answer
  /// until the timeout.
  static Result<std::unique_ptr<SkillProvider>> connect(const std::string& endpoint,
                                                        const std::string& name,
                                                        const ConnectOptions& options = {});
  virtual ~SkillProvider() = default;

  /// Adds a skill by its description in YAML (docs/skills.md), or by the name of one that is known
  /// before. Returns once it can be executed.
  /// Errors: kInvalidArgument naming line and key; kAlreadyExists if it has such a skill;
  /// kFailedPrecondition if another version is known before; kUnavailable without an answer.
  virtual Status add(std::string_view description, SkillFunction function) = 0;

  /// Removes a skill. What runs of it goes on.
  /// Errors: kNotFound; kUnavailable.
  virtual Status remove(const std::string& skill) = 0;

  /// How many executions run now.
  [[nodiscard]] virtual size_t running() const = 0;
};

}  // namespace engram
