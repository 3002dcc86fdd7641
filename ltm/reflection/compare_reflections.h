// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/reflection/reflection.h"

namespace engram::ltm {

/// In what two stores differ.
struct ReflectionDifference {
  std::string object;  ///< An entity or a skill.
  std::string what;    ///< "rate", "idle time", "positions[3]", "success", "dead-link", ...
  std::string here;    ///< In the store that is looked at.
  std::string there;   ///< In the one that it is compared with.
};

/// Entities that only one has, rates, idle time, ranges of numbers that have left each other,
/// rates of success whose intervals do not meet, and numbers of findings. What differs by chance
/// is left out.
[[nodiscard]] std::vector<ReflectionDifference> compare_reflections(const Reflection& here,
                                                                    const Reflection& there);

}  // namespace engram::ltm
