// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/finding_list.h"

#include "tests/ltm/reflection/example_arm.h"

namespace engram::ltm {
namespace {

ReflectionFinding finding_at(int row, const std::string& member = "x") {
  const Time time = ExampleArm::arm_time(row);
  return {ReflectionKind::kSpike, Severity::kFault, ExampleArm::id(), member, time, time};
}

TEST(FindingList, NeighboursBecomeOne) {
  FindingList list;
  for (int i = 0; i < 50; ++i) {
    list.add(finding_at(i, "x"));
    list.add(finding_at(i, "y"));
  }
  list.add(finding_at(500));
  uint64_t untold = 7;
  const auto found = list.take(untold);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].count, 50u);
  EXPECT_EQ(found[0].last, ExampleArm::arm_time(49));
  EXPECT_EQ(untold, 0u);
}

TEST(FindingList, TellsABoundedNumberAndCountsTheRest) {
  FindingList list;
  for (int i = 0; i < 1000; ++i) list.add(finding_at(1000 * i));
  uint64_t untold = 0;
  EXPECT_EQ(list.take(untold).size(), FindingList::kMaxTold);
  EXPECT_EQ(untold, 1000 - FindingList::kMaxTold);
}

TEST(FindingList, FaultsComeFirst) {
  FindingList list;
  ReflectionFinding note = finding_at(0);
  note.severity = Severity::kNote;
  list.add(note);
  list.add(finding_at(900));
  uint64_t untold = 0;
  const auto found = list.take(untold);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].severity, Severity::kFault);
}

}  // namespace
}  // namespace engram::ltm
