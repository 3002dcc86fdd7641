// SPDX-License-Identifier: Apache-2.0
// A network that learns from cells that say plainly what they show.
#include "speech/sights/sight_fit.h"

#include <gtest/gtest.h>

#include "tests/ltm/expect_status.h"

namespace engram::speech {
namespace {

constexpr int64_t kCellsAcross = 6;
constexpr int64_t kKinds = 2;
constexpr int64_t kChannels = 6;  ///< One of each kind, place and colour.
constexpr SightShape kShape{.channels = kChannels, .kinds = kKinds, .places = 2, .colours = 2};

/// Images with a thing of the one kind, the other, or none, somewhere; and noise.
SightBatch images(int64_t count, int64_t seed) {
  torch::manual_seed(seed);
  SightBatch batch{.cells = 0.1 * torch::randn({count, kChannels, kCellsAcross, kCellsAcross}),
                   .kinds = torch::full({count, kCellsAcross, kCellsAcross}, kKinds, torch::kLong),
                   .where = torch::full({count, kKinds}, SightBatch::kNotLearned, torch::kLong),
                   .colours = torch::full({count, kKinds}, SightBatch::kNotLearned, torch::kLong),
                   .sight = torch::zeros({count, kKinds}, torch::kBool)};
  const torch::Tensor chosen = torch::randint(0, 1 << 30, {count, 5}, torch::kLong);
  for (int64_t i = 0; i < count; ++i) {
    const auto pick = [&](int64_t column, int64_t below) {
      return chosen[i][column].item<int64_t>() % below;
    };
    const int64_t kind = pick(0, kKinds + 1);
    if (kind == kKinds) continue;
    const int64_t row = pick(1, kCellsAcross), column = pick(2, kCellsAcross);
    const int64_t place = pick(3, 2), colour = pick(4, 2);
    for (const int64_t channel : {kind, 2 + place, 4 + colour})
      batch.cells[i][channel][row][column] += 2;
    batch.kinds[i][row][column] = kind;
    batch.where[i][kind] = place;
    batch.colours[i][kind] = colour;
    batch.sight[i][kind] = true;
  }
  batch.cells = batch.cells.to(torch::kHalf);
  return batch;
}

SightsReport fitted(const SightBatch& learned) {
  SightsReport report;
  SightLayers layers(kShape);
  LearnSightsOptions options;
  options.budget = std::chrono::seconds(6);
  EXPECT_OK(fit_sights(layers, learned, options, report, {}, {}));
  measure_sights(layers, images(300, 2), report);
  return report;
}

TEST(SightFit, LearnsWhatCellsShow) {
  const SightsReport report = fitted(images(600, 1));
  EXPECT_GT(report.found, 0.9);
  EXPECT_GT(report.found_rightly, 0.9);
  EXPECT_GT(report.place_right, 0.9);
  EXPECT_GT(report.colour_right, 0.9);
}

TEST(SightFit, LearnsNoColoursFromThoseThatAreWrong) {
  SightBatch wrong = images(600, 1);
  wrong.colours = torch::where(wrong.colours.ge(0), 1 - wrong.colours, wrong.colours);
  EXPECT_LT(fitted(wrong).colour_right, 0.1);
}

TEST(SightFit, EndsWhenItIsStopped) {
  std::stop_source stop;
  stop.request_stop();
  SightsReport report;
  SightLayers layers(kShape);
  EXPECT_EQ(fit_sights(layers, images(10, 1), {}, report, {}, stop.get_token()).code(),
            StatusCode::kCancelled);
}

}  // namespace
}  // namespace engram::speech
