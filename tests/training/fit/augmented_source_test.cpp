// SPDX-License-Identifier: Apache-2.0
// What is trained on beside the recorded snapshots: training/fit/augmented_source.h,
// augmented_rows.h.
#include "training/fit/augmented_source.h"

#include <gtest/gtest.h>

#include <set>

#include "ltm/core/file.h"
#include "tests/ltm/expect_status.h"
#include "tests/training/recorded_scene.h"
#include "training/augment/augment_store.h"
#include "training/fit/augmented_rows.h"
#include "training/fit/checkpoint.h"
#include "training/fit/load_dataset.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::quick_consolidation;
using engram::testing::quick_options;
using engram::testing::record;
using engram::testing::ScratchPath;

const ltm::MemoryId kEntity = id("Test/Scene/sim/square");
constexpr int kCount = 40;

class AugmentedSource : public ::testing::Test {
 protected:
  void SetUp() override {
    record(real_.path(), kEntity.to_string(), 0, kCount);
    training::AugmentOptions options;
    options.query = *ltm::Query::parse("@ all");
    options.copies = 2;
    options.hold = std::chrono::seconds(2);  // 10 snapshots.
    ASSERT_OK(training::augment_store(real_.path(), augmented_.path(), options, {}, {}));
  }

  Result<AugmentedValues> find(const TrainingSource& source) {
    return find_augmented(augmented_.path(), kEntity, source, {});
  }

  const ScratchPath real_{"real"};
  const ScratchPath augmented_{"augmented"};
};

TEST_F(AugmentedSource, FindsRunsThatWereChangedAlike) {
  const auto values = find(engram::testing::scene_source(kCount));
  ASSERT_OK(values);
  EXPECT_EQ(values->left_out, 0u);
  size_t total = 0;
  for (const auto& run : values->origins) {
    EXPECT_LE(run.size(), 10u);
    for (size_t i = 1; i < run.size(); ++i) EXPECT_EQ(run[i], run[i - 1] + 1);
    total += run.size();
  }
  EXPECT_EQ(total, 2u * kCount);
  const auto value = values->read(0, 0);
  ASSERT_OK(value);
  EXPECT_NE(*value, engram::testing::scene_at(static_cast<int>(values->origins[0][0])));
  EXPECT_EQ(*value->at("joints"),
            *engram::testing::scene_at(static_cast<int>(values->origins[0][0])).at("joints"));
}

TEST_F(AugmentedSource, LeavesOutWhatWasMadeOfOthersThanThoseTrainedOn) {
  TrainingSource source = engram::testing::scene_source(kCount);
  const std::set<Time> left_out(source.times.begin() + 15, source.times.begin() + 25);
  std::erase_if(source.times, [&](Time time) { return left_out.contains(time); });
  const auto values = find(source);
  ASSERT_OK(values);
  EXPECT_EQ(values->left_out, 20u);
  for (const auto& run : values->origins)
    for (const size_t origin : run) EXPECT_LT(origin, source.times.size());
}

TEST_F(AugmentedSource, EndsRunsWhereRecordingsEnd) {
  TrainingSource source = engram::testing::scene_source(kCount);
  source.times.erase(source.times.begin() + 13, source.times.begin() + 16);
  const auto values = find(source);
  ASSERT_OK(values);
  for (const auto& run : values->origins)
    EXPECT_EQ(run.front() < 13, run.back() < 13) << run.front() << " to " << run.back();
}

TEST_F(AugmentedSource, RefusesAStoreOfRealSnapshots) {
  EXPECT_FAILS(find_augmented(real_.path(), kEntity, engram::testing::scene_source(kCount), {}),
               StatusCode::kInvalidArgument, "is not augmented");
  const auto other = find_augmented(augmented_.path(), id("Test/Scene/sim/other"),
                                    engram::testing::scene_source(kCount), {});
  ASSERT_OK(other);
  EXPECT_TRUE(other->origins.empty());
}

TEST_F(AugmentedSource, MarksWhatWasMadeOfHeldOutRowsAndLeavesTheStatisticsAlone) {
  TrainingSource source = engram::testing::scene_source(kCount);
  const auto plain = load_dataset(source, quick_options(1), nullptr, {});
  ASSERT_OK(plain);
  EXPECT_FALSE(plain->augmented);
  source.augmented = *find(source);
  const auto data = load_dataset(source, quick_options(1), nullptr, {});
  ASSERT_OK(data);
  ASSERT_TRUE(data->augmented);
  EXPECT_EQ(data->size(), plain->size());
  EXPECT_EQ(data->mean, plain->mean);
  EXPECT_TRUE(data->backgrounds[0].equal(plain->backgrounds[0]));
  const AugmentedRows& rows = *data->augmented;
  EXPECT_EQ(rows.size(), 2u * kCount);
  // The last 15 % of 40 in each copy.
  size_t held_out = 0;
  for (size_t s = 0; s < rows.sequences.size(); ++s)
    held_out += rows.sequences[s].end - rows.first_held_out[s];
  EXPECT_EQ(held_out, 2u * 6u);
  EXPECT_EQ(rows.backgrounds[0].size(0), static_cast<int64_t>(rows.sequences.size()));
}

TEST_F(AugmentedSource, IsTrainedOnAndNeverEncoded) {
  auto options = quick_consolidation();
  options.augmented = augmented_.path();
  const auto report = consolidate(real_.path(), options, {}, {});
  ASSERT_OK(report);
  const EntityReport& entity = report->entities[0];
  EXPECT_EQ(entity.skipped_reason, "");
  EXPECT_EQ(entity.snapshots, kCount);
  EXPECT_EQ(entity.training.used_snapshots, kCount);
  EXPECT_EQ(entity.training.augmented, 2u * kCount);
  const auto alone = consolidate(augmented_.path(), quick_consolidation(), {}, {});
  ASSERT_OK(alone);
  EXPECT_EQ(alone->entities[0].skipped_reason,
            "0 recorded snapshots, needs 16; 40 are augmented, which no model encodes");
}

TEST_F(AugmentedSource, GivesTheSameModelForTheSameSeedAndAnotherForAnotherShare) {
  const auto bytes_of = [&](double share, bool is_augmented) {
    TrainingSource source = engram::testing::scene_source(kCount);
    if (is_augmented) source.augmented = *find(source);
    TrainOptions options = quick_options(12);
    options.augmented_share = share;
    const ScratchPath file("model");
    EXPECT_OK(train_model(source, options, file.path(), {}, {}));
    const Buffer content = *read_file(file.path());
    return std::string(as_text(content.bytes()));
  };
  const auto first = bytes_of(0.5, true);
  EXPECT_EQ(first, bytes_of(0.5, true));
  EXPECT_NE(first, bytes_of(0.25, true));
  EXPECT_EQ(bytes_of(0, true), bytes_of(0.5, false));
}

}  // namespace
}  // namespace engram::training
