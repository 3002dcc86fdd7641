// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/reflection/compare_reflections.h"
#include "ltm/reflection/reflection.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// What a store tells about itself, as `engram reflect --json` prints it.
[[nodiscard]] Json reflection_json(const ltm::Reflection& reflection);

/// A list of objects: [{"object", "what", "here", "there"}].
[[nodiscard]] Json differences_json(const std::vector<ltm::ReflectionDifference>& differences);

struct ReflectionTextOptions {
  /// Max number of findings that are told one by one; zero: all.
  size_t max_findings = 40;
  /// Tells of each entity, however many there are.
  bool are_all_entities = false;
};

/// Prints the same for people: findings, entities, skills, chains of failures.
void print_reflection(const ltm::Reflection& reflection, const ReflectionTextOptions& options);

void print_differences(const std::vector<ltm::ReflectionDifference>& differences,
                       const std::string& here, const std::string& there);

}  // namespace engram::reports
