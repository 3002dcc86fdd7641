// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/equality_filter.h"

#include <limits>

#include "tests/ltm/filter/candidates.h"

namespace engram::ltm {
namespace {

TEST(EqualityFilter, DropsWhatEqualsTheLastKept) {
  auto filter = *EqualityFilter::create({});
  FilterRun run(filter);
  for (const auto& [second, value] :
       std::vector<std::pair<double, int32_t>>{{0, 1}, {1, 1}, {2, 2}, {3, 2}, {4, 1}})
    run.offer(candidate(second, value));
  EXPECT_EQ(run.kept(), (std::vector<double>{0, 2, 4}));
  EXPECT_EQ(run.dropped("equal"), 2u);
}

TEST(EqualityFilter, ComparesBitsNotNumbers) {
  auto filter = *EqualityFilter::create({});
  FilterRun run(filter);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(run.keeps(candidate(0, nan)));
  EXPECT_FALSE(run.keeps(candidate(1, nan)));
  EXPECT_TRUE(run.keeps(candidate(2, 0.0)));
  EXPECT_TRUE(run.keeps(candidate(3, -0.0)));
  EXPECT_TRUE(run.keeps(candidate(4, 0.0f))) << "another type";
}

TEST(EqualityFilter, KeepsOneAfterTheLongestGap) {
  auto filter = *EqualityFilter::create({.max_gap = std::chrono::seconds(2)});
  FilterRun run(filter);
  for (int i = 0; i < 7; ++i) run.offer(candidate(i, 1));
  EXPECT_EQ(run.kept(), (std::vector<double>{0, 2, 4, 6}));
}

TEST(EqualityFilter, SeesAnotherNumberOfInstances) {
  auto filter = *EqualityFilter::create({});
  FilterRun run(filter);
  EXPECT_TRUE(run.keeps(candidate(0, 1)));
  Candidate two = candidate(1, 1);
  two.snapshot.instances.push_back(two.snapshot.instances.front());
  EXPECT_TRUE(run.keeps(two));
}

TEST(EqualityFilter, RefusesAGapOfNothing) {
  EXPECT_FAILS(EqualityFilter::create({.max_gap = Duration(0)}), StatusCode::kInvalidArgument,
               "max_gap is 0s");
}

}  // namespace
}  // namespace engram::ltm
