// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/ahead_limits.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

const Time kNow = time_from_ns(1'700'000'000'000'000'000);
const MemoryId kEntity = *MemoryId::parse("Vision/RGB/head/cam");

TEST(AheadLimits, TakeWhatIsNotTooFarAhead) {
  const auto check = [](Time time) { return check_ahead(kEntity, time, kNow, AheadLimits().all); };
  EXPECT_OK(check(kNow));
  EXPECT_OK(check(kNow + std::chrono::hours(1)));
  EXPECT_OK(check(time_from_ns(std::numeric_limits<int64_t>::min())));
  EXPECT_FAILS(check(kNow + std::chrono::hours(1) + std::chrono::nanoseconds(1)),
               StatusCode::kInvalidArgument, "needs at most 1h (max_ahead)");
}

TEST(AheadLimits, RefuseTheEndOfTimeAtAnyClock) {
  const Time end = time_from_ns(std::numeric_limits<int64_t>::max());
  for (const int64_t now : {std::numeric_limits<int64_t>::min(), int64_t{-1}, int64_t{0}})
    EXPECT_FAILS(check_ahead(kEntity, end, time_from_ns(now), std::chrono::hours(1)),
                 StatusCode::kInvalidArgument, "ahead of the clock");
  EXPECT_OK(check_ahead(kEntity, end, kNow, AheadLimits::kNone));
}

TEST(AheadLimits, OfTheLongestIdCount) {
  AheadLimits limits;
  limits.parts = {{kEntity, std::chrono::seconds(2)},
                  {*MemoryId::parse("Vision"), std::chrono::seconds(1)},
                  {*MemoryId::parse("Plan"), AheadLimits::kNone}};
  EXPECT_EQ(limits.of(kEntity), std::chrono::seconds(2));
  EXPECT_EQ(limits.of(*MemoryId::parse("Vision/RGB/head/other")), std::chrono::seconds(1));
  EXPECT_EQ(limits.of(*MemoryId::parse("Plan/a/b/c")), AheadLimits::kNone);
  EXPECT_EQ(limits.of(*MemoryId::parse("Other/a/b/c")), limits.all);
  EXPECT_OK(limits.validate());
  limits.parts[1].second = std::chrono::seconds(-1);
  EXPECT_FAILS(limits.validate(), StatusCode::kInvalidArgument, "max_ahead of 'Vision'");
}

}  // namespace
}  // namespace engram::ltm
