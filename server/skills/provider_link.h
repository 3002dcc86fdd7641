// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/memory/memory_id.h"

namespace engram::skills {

/// How an execution ended, as its provider says. The values are those of skill::Outcome.
enum class SkillOutcome : uint8_t { kSuccess = 1, kFailure = 2, kStop = 3 };

/// What a provider is told to execute.
struct SkillStart {
  std::string execution;  ///< ID of the event at which it started.
  std::string skill;
  std::string parameters_json;  ///< As used: all of them, of their types.
  std::string request;          ///< ID of the request.
};

/// What a provider has: the first thing that it says.
struct ProviderHello {
  std::string provider;
  /// Descriptions in YAML; "NAME" alone: the one that is known before.
  std::vector<std::string> skills;
};

/// What a provider has from now on, or no longer.
struct ProviderChange {
  std::vector<std::string> added;    ///< As in ProviderHello.
  std::vector<std::string> removed;  ///< Names of its skills.
};

/// What a provider says of an execution.
struct SkillReport {
  std::string execution;
  std::string data_json;           ///< Any value as JSON; empty: none.
  std::vector<std::string> links;  ///< IDs of what it made or found.
  bool is_end = false;
  // If it is the end:
  SkillOutcome outcome = SkillOutcome::kSuccess;
  std::string reason;
};

/// The way to a provider.
///
/// Threading: thread-safe; the calls do not wait.
class ProviderLink {
 public:
  virtual ~ProviderLink() = default;

  /// Whether what it has was taken: once for its first words, and once for each change. If its
  /// first words were not, nothing else follows.
  virtual void welcome(const Status& status) = 0;
  virtual void start(const SkillStart& start) = 0;
  virtual void stop(const std::string& execution, const std::string& reason) = 0;
};

}  // namespace engram::skills
