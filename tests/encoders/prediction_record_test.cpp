// SPDX-License-Identifier: Apache-2.0
#include "encoders/prediction_record.h"

#include <gtest/gtest.h>

#include <cmath>

#include "encoders/model_records.h"
#include "encoders/model_vectors.h"
#include "tests/training/moving_scene.h"

namespace engram::encoders {
namespace {

using engram::testing::ScratchPath;

PredictionRecord example_record() {
  PredictionRecord record;
  record.step = std::chrono::milliseconds(200);
  for (size_t i = 0; i < kMeasuredHorizons; ++i) {
    const auto x = static_cast<double>(i + 1);
    record.image_gates[i] = 0.25;
    record.motion_gates[i] = 0.5;
    record.number_gates[i] = 0.75;
    record.errors[i].images = {1, 0.5, 3 * x, 9 * x, 20 * x, 40 - static_cast<int64_t>(i)};
    record.errors[i].numbers = {1e-6, 1, 0.1 * x, std::nan(""), 0.2 * x, 7};
  }
  return record;
}

/// Writes a record, lets `damage` change its numbers, and reads it.
Result<PredictionRecord> read_again(const PredictionRecord& record,
                                    const std::function<void(std::vector<double>&)>& damage) {
  const ScratchPath path("prediction_record");
  const ScratchPath damaged("prediction_damaged");
  std::vector<double> numbers;
  {
    auto file = h5::File::create(path.path());
    EXPECT_TRUE(write_prediction(*file, "/prediction", record).ok());
    EXPECT_TRUE(file->close().ok());
  }
  numbers = *read_vector<double>(*h5::File::open(path.path()), "/prediction/horizons");
  damage(numbers);
  {
    auto file = h5::File::create(damaged.path());
    EXPECT_TRUE(write_vector(*file, "/prediction/horizons", numbers).ok());
    EXPECT_TRUE(file->write_attribute("/prediction", "step_ns", int64_t{200'000'000}).ok());
    EXPECT_TRUE(file->close().ok());
  }
  return read_prediction(*h5::File::open(damaged.path()), "/prediction");
}

TEST(PredictionRecord, ComesBackFromItsFile) {
  const PredictionRecord record = example_record();
  const auto again = read_again(record, [](std::vector<double>&) {});
  ASSERT_TRUE(again.ok()) << again.status().to_string();
  EXPECT_EQ(again->step, record.step);
  EXPECT_EQ(again->image_gates, record.image_gates);
  EXPECT_EQ(again->motion_gates, record.motion_gates);
  EXPECT_EQ(again->number_gates, record.number_gates);
  for (int steps = 1; steps <= kMeasuredHorizons + 1; ++steps)
    EXPECT_EQ(again->estimate({24, 0.5}, steps), record.estimate({24, 0.5}, steps)) << steps;
  EXPECT_EQ(again->horizons().at(2).predictions, 38u);
}

TEST(PredictionRecord, RefusesNumbersThatCannotBe) {
  using Damage = std::function<void(std::vector<double>&)>;
  // Per horizon: three gates, then least change, exponent, expected, bound, mean and count, twice.
  const std::vector<Damage> damages{
      [](auto& numbers) { numbers.pop_back(); },
      [](auto& numbers) { numbers.clear(); },
      [](auto& numbers) { numbers.push_back(0); },
      [](auto& numbers) { numbers[0] = 1.5; },
      [](auto& numbers) { numbers[15] = std::nan(""); },
      [](auto& numbers) { numbers[3] = 0; },
      [](auto& numbers) { numbers[3] = std::nan(""); },
      [](auto& numbers) { numbers[4] = 1.01; },
      [](auto& numbers) { numbers[4] = -0.01; },
      [](auto& numbers) { numbers[5] = -1; },
      [](auto& numbers) { numbers[6] = std::numeric_limits<double>::infinity(); },
      [](auto& numbers) { numbers[7] = -1; },
      [](auto& numbers) { numbers[8] = 1e300; },
      [](auto& numbers) { numbers[8] = std::nan(""); },
      [](auto& numbers) { numbers[14] = -1; }};
  for (size_t i = 0; i < damages.size(); ++i)
    EXPECT_EQ(read_again(example_record(), damages[i]).status().code(), StatusCode::kDataLoss) << i;
}

TEST(PredictionRecord, TellsMoreWhereMoreChanged) {
  const PredictionRecord record = example_record();
  const auto calm = record.estimate({3, 0.1}, 1), busy = record.estimate({399, 0.4}, 1);
  EXPECT_DOUBLE_EQ(calm.expected.image_mse, 3 * 2.0);
  EXPECT_DOUBLE_EQ(calm.bound.image_mse, 9 * 2.0);
  EXPECT_DOUBLE_EQ(busy.bound.image_mse, 9 * 20.0);
  EXPECT_GT(busy.expected.number_mse, 3 * calm.expected.number_mse);
  EXPECT_TRUE(std::isnan(busy.bound.number_mse)) << "too few were measured";
}

TEST(PredictionRecord, HasNoBoundBeyondWhatWasMeasured) {
  const PredictionRecord record = example_record();
  const auto last = record.estimate({24, 0.5}, kMeasuredHorizons);
  const auto beyond = record.estimate({24, 0.5}, kMeasuredHorizons + 1);
  EXPECT_FALSE(std::isnan(last.bound.image_mse));
  EXPECT_EQ(beyond.expected, last.expected);
  EXPECT_TRUE(std::isnan(beyond.bound.image_mse));
}

TEST(PredictionRecord, NamesTheHorizonsThatWereMeasured) {
  PredictionRecord record = example_record();
  record.errors[1].images.measured = record.errors[1].numbers.measured = 0;
  const auto horizons = record.horizons();
  ASSERT_EQ(horizons.size(), 4u);
  EXPECT_EQ(horizons[1].steps, 3);
  EXPECT_EQ(horizons[1].mean.image_mse, 60);
  EXPECT_TRUE(PredictionRecord().horizons().empty());
}

}  // namespace
}  // namespace engram::encoders
