// SPDX-License-Identifier: Apache-2.0
#include "training/fit/row_rotation.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/training/moving_scene.h"
#include "training/fit/load_dataset.h"

namespace engram::training {
namespace {

using engram::testing::quick_options;
using engram::testing::scene_source;

constexpr int kRowCount = 500;

class RowRotationTest : public ::testing::Test {
 protected:
  RowRotationTest() {
    options_.memory_bytes =
        150 * (engram::testing::kWidth * engram::testing::kHeight * 3 + 3 * sizeof(double));
  }

  Dataset loaded() {
    auto data = load_dataset(source_, options_, nullptr, {});
    EXPECT_TRUE(data.ok()) << data.status().to_string();
    return *std::move(data);
  }

  /// What is in memory must be what the source has of the rows that are told.
  void expect_true_rows(const Dataset& data) {
    for (size_t i = 0; i < data.sequences.size(); ++i) {
      const auto rows = read_rows(source_, data, data.source_rows[i]);
      ASSERT_TRUE(rows.ok());
      const auto first = static_cast<int64_t>(data.sequences[i].first);
      const auto end = static_cast<int64_t>(data.sequences[i].end);
      EXPECT_TRUE(data.images[0].slice(0, first, end).equal(rows->images[0]));
      EXPECT_TRUE(data.plain_numbers.slice(0, first, end).equal(rows->plain_numbers));
      EXPECT_TRUE(data.numbers.slice(0, first, end)
                      .equal(normalised(rows->plain_numbers, data.mean, data.deviation)));
      EXPECT_EQ(data.times[data.sequences[i].first], source_.times[data.source_rows[i].first]);
    }
  }

  TrainingSource source_ = scene_source(kRowCount, 2);
  TrainOptions options_ = quick_options(1);
};

TEST_F(RowRotationTest, BringsInEverythingThatIsTrainedOn) {
  Dataset data = loaded();
  ASSERT_GT(data.left_out_runs.size(), 5u);
  std::set<size_t> wanted, seen;
  for (const Sequence& run : data.left_out_runs)
    if (run.size() == 32) wanted.insert(run.first);
  std::vector<Sequence> held_out;
  for (size_t i = 0; i < data.sequences.size(); ++i)
    if (data.first_held_out[i] != data.sequences[i].end) held_out.push_back(data.source_rows[i]);
  ASSERT_FALSE(held_out.empty());
  RowSampler sampler(data.sequences, data.first_held_out);
  RowRotation rotation(source_, data, 1);
  for (int64_t step = 0; step < 80; ++step) {
    ASSERT_TRUE(rotation.advance(step, sampler).ok());
    for (const Sequence& rows : data.source_rows) seen.insert(rows.first);
  }
  for (const size_t first : wanted) EXPECT_TRUE(seen.contains(first)) << first;
  std::vector<Sequence> held_out_after;
  for (size_t i = 0; i < data.sequences.size(); ++i)
    if (data.first_held_out[i] != data.sequences[i].end)
      held_out_after.push_back(data.source_rows[i]);
  EXPECT_EQ(held_out_after, held_out);
  expect_true_rows(data);
}

TEST_F(RowRotationTest, GoesOnWithWhatWasInMemory) {
  Dataset one = loaded(), other = loaded();
  RowSampler sampler(one.sequences, one.first_held_out);
  RowRotation from_start(source_, one, 3), from_later(source_, other, 3);
  for (int64_t step = 0; step <= 44; ++step) ASSERT_TRUE(from_start.advance(step, sampler).ok());
  ASSERT_TRUE(from_later.advance(44, sampler).ok());
  EXPECT_EQ(one.source_rows, other.source_rows);
  expect_true_rows(other);
  for (const int64_t step : {50, 60}) {
    ASSERT_TRUE(from_start.advance(step, sampler).ok());
    ASSERT_TRUE(from_later.advance(step, sampler).ok());
    EXPECT_EQ(one.source_rows, other.source_rows);
  }
}

TEST_F(RowRotationTest, ForgetsTheCostsOfRowsThatWent) {
  Dataset data = loaded();
  RowSampler sampler(data.sequences, data.first_held_out);
  for (size_t row = 0; row < data.size(); ++row) sampler.told(static_cast<int64_t>(row), 1.5);
  const std::vector<Sequence> before = data.source_rows;
  RowRotation rotation(source_, data, 1);
  ASSERT_TRUE(rotation.advance(0, sampler).ok());
  ASSERT_TRUE(rotation.advance(4, sampler).ok());
  size_t replaced = 0;
  for (size_t i = 0; i < before.size(); ++i) {
    const bool is_new = before[i] != data.source_rows[i];
    replaced += is_new ? 1 : 0;
    EXPECT_EQ(*sampler.state()[data.sequences[i].first], is_new ? 0 : 1.5);
  }
  EXPECT_EQ(replaced, 1u);
}

TEST_F(RowRotationTest, DoesNothingWhereAllIsInMemory) {
  options_.memory_bytes = uint64_t{1} << 30;
  Dataset data = loaded();
  EXPECT_TRUE(data.left_out_runs.empty());
  const std::vector<Sequence> before = data.source_rows;
  RowSampler sampler(data.sequences, data.first_held_out);
  RowRotation rotation(source_, data, 1);
  ASSERT_TRUE(rotation.advance(400, sampler).ok());
  EXPECT_EQ(data.source_rows, before);
}

TEST_F(RowRotationTest, TellsWhatCannotBeRead) {
  Dataset data = loaded();
  source_.read = [](size_t) -> Result<idf::Data> { return data_loss("a block is damaged"); };
  RowSampler sampler(data.sequences, data.first_held_out);
  RowRotation rotation(source_, data, 1);
  ASSERT_TRUE(rotation.advance(0, sampler).ok());
  EXPECT_EQ(rotation.advance(4, sampler).code(), StatusCode::kDataLoss);
}

}  // namespace
}  // namespace engram::training
