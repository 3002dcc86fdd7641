// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/learn_space.h"

#include <cmath>
#include <random>

#include "ltm/likeness/likeness_space.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

/// Descriptors that depend on a pose a little and on the room much, of 4 recordings.
struct Rooms {
  LikenessSamples samples;
  std::vector<double> poses;

  explicit Rooms(bool has_views) {
    std::mt19937 random(7);
    std::normal_distribution<float> noise;
    std::vector<std::vector<float>> of_room(4, std::vector<float>(kDescriptorSize));
    std::vector<float> of_pose(kDescriptorSize), of_turn(kDescriptorSize), drift(kDescriptorSize);
    for (auto* direction : {&of_pose, &of_turn, &drift})
      for (float& number : *direction) number = 0.02f * noise(random);
    for (auto& room : of_room)
      for (float& number : room) number = 0.05f * noise(random);
    for (size_t room = 0; room < 4; ++room) {
      for (int i = 0; i < 50; ++i) {
        const double pose = std::sin(0.3 * i + static_cast<double>(room));
        const double turn = std::cos(0.3 * i + static_cast<double>(room));
        const float light = 4 * noise(random);
        std::vector<float> descriptor(kDescriptorSize);
        for (size_t j = 0; j < kDescriptorSize; ++j)
          descriptor[j] = of_room[room][j] + static_cast<float>(pose) * of_pose[j] +
                          static_cast<float>(turn) * of_turn[j] + light * drift[j] +
                          0.001f * noise(random);
        samples.times.push_back(
            time_from_ns((static_cast<int64_t>(room) * 1000 + i) * 200'000'000));
        samples.descriptors.push_back(std::move(descriptor));
        samples.views.push_back(has_views ? std::vector{pose, turn} : std::vector<double>());
        poses.push_back(std::atan2(turn, pose));
      }
      samples.recordings.push_back({50 * room, 50 * room + 50});
    }
  }

  /// The mean error of the pose of the nearest code in another room. Unit: rad.
  [[nodiscard]] double error() const {
    const LearnedProjection learned = learn_projection(samples);
    LikenessSpace space;
    space.mean = learned.mean;
    space.projection = learned.projection;
    std::vector<std::vector<int8_t>> codes;
    for (const auto& descriptor : samples.descriptors) codes.push_back(space.code(descriptor));
    double sum = 0;
    for (size_t i = 0; i < codes.size(); ++i) {
      double nearest = 1e30, error = 0;
      for (size_t j = 0; j < codes.size(); ++j) {
        if (i / 50 == j / 50) continue;
        double square = 0;
        for (size_t k = 0; k < kCodeSize; ++k) square += std::pow(codes[i][k] - codes[j][k], 2);
        if (square >= nearest) continue;
        nearest = square;
        error = std::abs(std::remainder(poses[i] - poses[j], 2 * M_PI));
      }
      sum += error;
    }
    return sum / static_cast<double>(codes.size());
  }
};

TEST(LearnSpace, KeepsWhatIsAlikeInAllRoomsWhereViewsTellIt) {
  const double with = Rooms(true).error(), without = Rooms(false).error();
  EXPECT_LT(with, 0.3);
  EXPECT_GT(without, 3 * with);
}

TEST(LearnSpace, PairsMomentsOfDifferentRecordingsWithNearViews) {
  const Rooms rooms(true);
  const auto pairs = alike_pairs(rooms.samples);
  ASSERT_GT(pairs.size(), 200u);
  for (const auto& [a, b] : pairs) {
    EXPECT_NE(a / 50, b / 50);
    EXPECT_LT(std::abs(std::remainder(rooms.poses[a] - rooms.poses[b], 2 * M_PI)), 0.3);
  }
}

TEST(LearnSpace, GivesTheSameProjectionForTheSameSamples) {
  const auto a = learn_projection(Rooms(true).samples), b = learn_projection(Rooms(true).samples);
  EXPECT_EQ(a.projection, b.projection);
  EXPECT_EQ(a.mean, b.mean);
}

TEST(LearnSpace, TakesSamplesThatAreAllEqual) {
  LikenessSamples samples;
  for (int i = 0; i < 20; ++i) {
    samples.times.push_back(time_from_ns(i));
    samples.descriptors.emplace_back(kDescriptorSize, 0.5f);
    samples.views.push_back({1.0});
  }
  samples.recordings = {{0, 10}, {10, 20}};
  for (const float weight : learn_projection(samples).projection)
    EXPECT_TRUE(std::isfinite(weight));
}

TEST(LikenessSpace, IsReadAsItWasPacked) {
  LikenessSpace space;
  const auto learned = learn_projection(Rooms(true).samples);
  space.size = {64, 48, 3};
  space.snapshots = 200;
  space.recordings = 4;
  space.views = {*MemoryId::parse("RobotState/Proprioception/arm/joints")};
  space.mean = learned.mean;
  space.projection = learned.projection;
  const auto again = LikenessSpace::unpack(space.pack());
  ASSERT_OK(again);
  EXPECT_EQ(again->size, space.size);
  EXPECT_EQ(again->views, space.views);
  EXPECT_EQ(again->id(), LikenessSpace::unpack(again->pack())->id());
  const Rooms rooms(true);
  for (const auto& descriptor : rooms.samples.descriptors) {
    const auto a = space.code(descriptor), b = again->code(descriptor);
    for (size_t i = 0; i < kCodeSize; ++i) EXPECT_NEAR(a[i], b[i], 1);
  }
}

TEST(LikenessSpace, RefusesWhatIsCutOff) {
  LikenessSpace space;
  space.mean.resize(kDescriptorSize);
  space.projection.resize(kDescriptorSize * kCodeSize);
  const auto bytes = space.pack();
  for (size_t size = 0; size < bytes.size(); size += 3)
    EXPECT_EQ(LikenessSpace::unpack(std::span(bytes).first(size)).status().code(),
              StatusCode::kDataLoss);
}

}  // namespace
}  // namespace engram::ltm
