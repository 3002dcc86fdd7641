// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/selector.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/memory/random_memory.h"

namespace engram::ltm {
namespace {

TEST(Selector, ReadsBackEveryOne) {
  RandomValues random(71);
  for (int i = 0; i < 10000; ++i) {
    const Selector selector = random_selector(random);
    ASSERT_OK(validate(selector));
    const auto read = parse_selector(to_string(selector));
    ASSERT_OK(read);
    EXPECT_EQ(*read, selector) << to_string(selector);
  }
}

TEST(Selector, RefusesWhatSelectsNothing) {
  const Time late = time_from_ns(5), early = time_from_ns(1);
  const std::pair<Selector, const char*> cases[] = {
      {select::Latest{0}, "above zero"},
      {select::Latest{-1}, "above zero"},
      {select::Nearest{late, Duration(-1)}, "negative"},
      {select::TimeRange{late, early}, "ends before it starts"},
      {select::LastDuration{Duration(-1)}, "positive duration"}};
  for (const auto& [selector, part] : cases) {
    EXPECT_FAILS(validate(selector), StatusCode::kInvalidArgument, part);
    EXPECT_FAILS(parse_selector(to_string(selector)), StatusCode::kInvalidArgument, part);
  }
}

TEST(Selector, UntilIsEverythingUpToATime) {
  const Selector until(select::TimeRange{Time::min(), time_from_ns(5)});
  EXPECT_EQ(parse_selector("until:5").value(), until);
  EXPECT_EQ(parse_selector(to_string(until)).value(), until);
  EXPECT_FAILS(parse_selector("until:soon"), StatusCode::kInvalidArgument, "soon");
}

TEST(Selector, TakesSpacesAroundTimes) {
  EXPECT_EQ(parse_selector(" nearest: 5 ~ 1s ").value(),
            Selector(select::Nearest{time_from_ns(5), std::chrono::seconds(1)}));
  EXPECT_EQ(parse_selector("before: 5").value(), Selector(select::Before{time_from_ns(5), false}));
  EXPECT_EQ(parse_selector("-3 .. -1").value(), Selector(select::IndexRange{-3, -1}));
}

}  // namespace
}  // namespace engram::ltm
