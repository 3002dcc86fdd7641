// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/compare_reflections.h"

#include <gmock/gmock.h>

#include "tests/ltm/reflection/example_arm.h"

namespace engram::ltm {
namespace {

std::vector<std::string> whats(const std::vector<ReflectionDifference>& differences) {
  std::vector<std::string> found;
  for (const ReflectionDifference& difference : differences) found.push_back(difference.what);
  return found;
}

TEST(CompareReflections, EqualStoresDoNotDiffer) {
  const Reflection found = ExampleArm().reflect();
  EXPECT_EQ(compare_reflections(found, found).size(), 0u);
}

TEST(CompareReflections, TellsRatesRangesAndFindings) {
  const Reflection usual = ExampleArm().reflect();
  ExampleArm arm;
  for (int i = ExampleArm::kRows - 1; i > 0; i -= 2) arm.updates.erase(arm.updates.begin() + i);
  arm.change(0, 999, 2, [](int, double value) { return value + 3; });
  arm.change(500, 500, 0, [](int, double) { return INFINITY; });
  arm.add(ExampleArm::id("Robot/State/arm/tool"), ExampleArm::arm_time(0), 1.0);
  const auto found = whats(compare_reflections(arm.reflect(), usual));
  for (const char* what : {"rate", "positions[2]", "not-finite", "entity"})
    EXPECT_THAT(found, ::testing::Contains(what));
}

}  // namespace
}  // namespace engram::ltm
