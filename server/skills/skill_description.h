// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/skills/parameter_set.h"
#include "server/skills/skill_condition.h"

namespace engram::skills {

/// What a provider says of one of its skills.
///
/// Threading: immutable.
/// Source: docs/skills.md, "Description".
struct SkillDescription {
  static constexpr size_t kMaxBytes = size_t{64} << 10;

  std::string name;
  std::string doc;
  std::string version = "1";
  ParameterSet parameters;
  Condition pre;   ///< Must be met for it to start.
  Condition hold;  ///< Must be met as long as it runs; then it is stopped.
  Condition post;  ///< Must be met after it has succeeded, or it has failed.
  Condition when;  ///< Starts it as soon as this becomes true; empty: nothing does.
  /// How long it may take after it ended until `post` is met.
  Duration post_within{};
  /// What no other execution may use at the same time: "arm", or "arm/$hand".
  std::vector<std::string> resources;
  int max_running = 1;              ///< How many executions of it may run at once.
  std::optional<Duration> timeout;  ///< Empty: it may take any time.
  /// How long it has to end after it was told to stop; then it counts as failed.
  Duration stops_within = std::chrono::seconds(2);
  std::string text;  ///< What it was read from.

  /// Reads a description in YAML.
  /// Errors: kInvalidArgument naming the line and the key.
  static Result<SkillDescription> parse(std::string_view yaml);
};

}  // namespace engram::skills
