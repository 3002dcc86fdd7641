// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/held_boxes.h"

#include <gmock/gmock.h>

#include <random>

namespace engram::ltm {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr Duration kHold = std::chrono::seconds(1);

Time at(int64_t ms) {
  return time_from_ns(ms * 1'000'000);
}

ImagePlace place(const std::string& member = "rgb") {
  return {0, member, 0};
}

/// What holds in an image in which nothing is seen.
std::vector<RelativeBox> holding(HeldBoxes& held, int64_t ms, const std::string& member = "rgb") {
  return held.hold(place(member), at(ms), kHold, {});
}

bool is_covered(const std::vector<RelativeBox>& boxes, const RelativeBox& box) {
  return std::ranges::any_of(boxes, [&](const RelativeBox& each) { return each.contains(box); });
}

/// Sees 20 people walk at 30 images a second.
class Walk {
 public:
  std::vector<RelativeBox> people() {
    std::vector<RelativeBox> boxes;
    std::uniform_real_distribution<double> step(-0.01, 0.01);
    for (double& x : x_) {
      x = std::clamp(x + step(random_), 0.0, 0.9);
      boxes.push_back({x, 0.3, x + 0.05 + step(random_), 0.6});
    }
    return boxes;
  }

 private:
  std::mt19937 random_{3};
  std::vector<double> x_ = std::vector<double>(20, 0.5);
};

TEST(HeldBoxes, HoldEveryBoxOfManyPeopleAsLongAsTheyAreTold) {
  HeldBoxes held;
  Walk walk;
  std::vector<std::pair<int64_t, RelativeBox>> seen;
  for (int image = 0; image < 120; ++image) {
    const int64_t ms = image * 33;
    held.begin(at(ms), kHold);
    const auto people = walk.people();
    auto all = held.hold(place(), at(ms), kHold, people);
    all.insert(all.end(), people.begin(), people.end());
    for (const auto& [when, box] : seen)
      if (ms - when <= 1000) {
        ASSERT_TRUE(is_covered(all, box)) << "seen at " << when << " ms, now " << ms;
      }
    for (const RelativeBox& box : people) seen.emplace_back(ms, box);
    EXPECT_LE(held.size(), HeldBoxes::kMax);
  }
}

TEST(HeldBoxes, TakeABoxThatIsSeenAgainForOne) {
  HeldBoxes held;
  const RelativeBox box{0.1, 0.1, 0.3, 0.3};
  for (int image = 0; image < 1000; ++image) {
    held.begin(at(image * 33), kHold);
    held.hold(place(), at(image * 33), kHold, {box});
  }
  EXPECT_EQ(held.size(), 1u);
  EXPECT_THAT(holding(held, 999 * 33 + 1000), ElementsAre(box));
  EXPECT_THAT(holding(held, 999 * 33 + 1001), IsEmpty());
}

TEST(HeldBoxes, DoNotHoldALargeOneLongerBecauseSmallOnesAreSeenInIt) {
  HeldBoxes held;
  const RelativeBox whole{0, 0, 1, 1}, small{0.4, 0.4, 0.5, 0.5};
  held.hold(place(), at(0), kHold, {whole});
  held.hold(place(), at(900), kHold, {small});
  EXPECT_THAT(holding(held, 1500), ElementsAre(small));
}

TEST(HeldBoxes, JoinThoseOfOneImageWhereThereAreTooMany) {
  HeldBoxes held(2);
  const RelativeBox left{0, 0, 0.1, 0.1}, near{0.1, 0, 0.2, 0.1}, far{0.8, 0.8, 0.9, 0.9};
  held.hold(place(), at(0), kHold, {left, far});
  held.hold(place(), at(500), kHold, {near});
  EXPECT_THAT(holding(held, 900), ElementsAre(far, hull(left, near)));
  EXPECT_THAT(holding(held, 1400), ElementsAre(hull(left, near)));
}

TEST(HeldBoxes, CountInAllImagesWhereTooManyImagesHaveOne) {
  HeldBoxes held(2);
  const RelativeBox box{0.1, 0.1, 0.2, 0.2};
  for (const char* member : {"a", "b", "c", "d"}) held.hold(place(member), at(0), kHold, {box});
  EXPECT_LE(held.size(), 2u);
  for (const char* member : {"a", "b", "c", "d"})
    EXPECT_TRUE(is_covered(holding(held, 500, member), box)) << member;
}

TEST(HeldBoxes, ForgetWhatDidNotCountForManySnapshots) {
  HeldBoxes held;
  held.hold(place(), at(0), kHold, {{0.1, 0.1, 0.2, 0.2}});
  for (int i = 1; i < HeldBoxes::kPatience; ++i) held.begin(at(100'000 + i), kHold);
  EXPECT_FALSE(held.empty());
  held.begin(at(200'000), kHold);
  EXPECT_TRUE(held.empty());
}

}  // namespace
}  // namespace engram::ltm
