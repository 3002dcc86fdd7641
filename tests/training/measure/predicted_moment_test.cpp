// SPDX-License-Identifier: Apache-2.0
#include "training/measure/predicted_moment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "encoders/load_model.h"
#include "tests/training/recorded_scene.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {
namespace {

using engram::testing::scene_at;
using engram::testing::ScratchPath;

constexpr Duration kStep = std::chrono::milliseconds(200);
const char* const kScene = "Test/Scene/sim/square";

ltm::MemoryId entity() {
  return engram::testing::id(kScene);
}

Time time_at(int index) {
  return engram::testing::scene_source(index + 1).times.back();
}

ltm::Recall open(const std::filesystem::path& store) {
  return {*ltm::StoreReader::open(store), encoders::load_model, nullptr, {}};
}

Result<PredictedMoment> predicted(ltm::Recall& recall, const ltm::PredictionRequest& request) {
  return predict_moment(source_of(recall, entity()), entity(), request, kStep);
}

TEST(PredictedMoment, StandsBesideWhatReallyCame) {
  const ScratchPath store("predicted_moment");
  engram::testing::record(store.path(), kScene, 0, 20);
  ltm::Recall recall = open(store.path());
  const auto moment = predicted(recall, {time_at(16), {kStep, 3 * kStep, 4 * kStep}, ""});
  ASSERT_TRUE(moment.ok()) << moment.status().to_string();
  EXPECT_EQ(moment->last.time, time_at(16));
  ASSERT_EQ(moment->horizons.size(), 3u);
  for (const auto& [place, came] : {std::pair{0, 17}, {1, 19}}) {
    const PredictedHorizon& horizon = moment->horizons[static_cast<size_t>(place)];
    ASSERT_TRUE(horizon.actual.has_value()) << came;
    EXPECT_EQ(horizon.actual->time, time_at(came));
    const auto copied = compare(scene_at(came), scene_at(16));
    EXPECT_EQ(horizon.copy_error->image_mse, copied->image_mse);
    EXPECT_EQ(*horizon.error, *horizon.copy_error) << "without a model it is a copy";
    EXPECT_EQ(horizon.copy_told, ltm::ErrorEstimate{});
    EXPECT_FALSE(horizon.is_within().has_value()) << "there is no bound";
  }
  EXPECT_FALSE(moment->horizons[2].actual.has_value());
  EXPECT_FALSE(moment->horizons[2].error.has_value());
}

TEST(PredictedMoment, TakesNothingThatIsHalfAStepAwayForWhatCame) {
  const ScratchPath store("predicted_between");
  engram::testing::record(store.path(), kScene, 0, 20);
  ltm::Recall recall = open(store.path());
  const auto actual_after = [&](Duration horizon) {
    return predicted(recall, {time_at(10), {horizon}, ""})->horizons[0].actual;
  };
  EXPECT_EQ(actual_after(kStep + kStep / 4)->time, time_at(11));
  EXPECT_FALSE(actual_after(kStep + kStep / 2).has_value());
  EXPECT_FALSE(actual_after(kStep / 4).has_value()) << "what it started from did not come";
}

TEST(PredictedMoment, IsWithinItsBoundInEveryKindThatHasOne) {
  const double unknown = std::nan("");
  const auto is_within = [](const ltm::MeasuredError& error, const ltm::MeasuredError& bound) {
    PredictedHorizon horizon;
    horizon.error = error;
    horizon.predicted.instances.push_back({0, {}, {}, ltm::MeasuredError{1, 1}, bound});
    return horizon.is_within();
  };
  EXPECT_EQ(is_within({4, 2}, {5, 3}), true);
  EXPECT_EQ(is_within({4, 2}, {4, 3}), true);
  EXPECT_EQ(is_within({4, 2}, {3, 3}), false);
  EXPECT_EQ(is_within({4, 2}, {5, 1}), false);
  EXPECT_EQ(is_within({4, 2}, {5, unknown}), true);
  EXPECT_EQ(is_within({unknown, 2}, {5, 1}), false);
  EXPECT_EQ(is_within({4, 2}, {unknown, unknown}), std::nullopt);
  EXPECT_EQ(PredictedHorizon().is_within(), std::nullopt);
}

TEST(PredictedMoment, FindsTheLastMomentWhoseFutureIsKnown) {
  const ScratchPath store("predicted_last");
  engram::testing::record(store.path(), kScene, 0, 20);
  ltm::Recall recall = open(store.path());
  const PredictionSource source = source_of(recall, entity());
  EXPECT_EQ(*last_known_from(source, entity(), 3 * kStep), time_at(16));
  EXPECT_EQ(*last_known_from(source, entity(), kStep + Duration(1)), time_at(17));
  EXPECT_EQ(last_known_from(source, entity(), 20 * kStep).status().code(), StatusCode::kNotFound);
  EXPECT_EQ(*step_of(recall, entity(), recall.engines(entity())->front()), kStep);
  EXPECT_EQ(*step_of(source, entity()), kStep);
}

TEST(PredictedMoment, IsToldByAModelWithItsBound) {
  const ScratchPath store("predicted_model");
  engram::testing::record(store.path(), kScene, 0, 130);
  const auto report = consolidate(store.path(), engram::testing::quick_consolidation(), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  ltm::Recall recall = open(store.path());
  const auto engines = recall.engines(entity());
  ASSERT_EQ(engines->size(), 2u);
  // 15 % are 20 windows one ahead: ten chose, ten calibrated.
  for (const ltm::Recall::Engine& engine : *engines) {
    const auto records = engine.predictor->records(ltm::PredictorInputs::kConditions);
    ASSERT_EQ(records.size(), 5u) << engine.predictor->name();
    // Copies learn nothing: of all 128 windows half calibrated.
    EXPECT_EQ(records[0].predictions, engine.model.empty() ? 64u : 10u);
    EXPECT_GT(records[0].mean.image_mse, 0);
    EXPECT_LT(records[0].mean.number_mse, records[4].mean.number_mse);
  }
  const auto moment = predicted(recall, {time_at(60), {kStep, 6 * kStep}, ""});
  ASSERT_TRUE(moment.ok()) << moment.status().to_string();
  const PredictedHorizon& next = moment->horizons[0];
  const ltm::InstanceResult& told = next.predicted.instances.at(0);
  EXPECT_LE(told.error->image_mse, told.bound->image_mse);
  EXPECT_LE(told.error->number_mse, told.bound->number_mse);
  EXPECT_GT(next.copy_told.bound.image_mse, 0);
  EXPECT_TRUE(next.is_within().has_value());
  EXPECT_TRUE(std::isnan(moment->horizons[1].predicted.instances.at(0).bound->image_mse))
      << "six steps ahead nothing was measured";
  // The errors of a copy are those of the last snapshot, whoever predicts.
  const auto copied = predicted(recall, {time_at(60), {kStep}, "copy-last"});
  EXPECT_EQ(*copied->horizons[0].error, *next.copy_error);
  EXPECT_EQ(copied->horizons[0].predicted.instances.at(0).bound, next.copy_told.bound);
}

TEST(Sweep, MeasuresEveryMomentThatHasAPastAndAFuture) {
  const ScratchPath store("sweep");
  engram::testing::record(store.path(), kScene, 0, 20);
  ltm::Recall recall = open(store.path());
  const ltm::Recall::PredictionRequest request{{}, {kStep, 2 * kStep}, ""};
  const auto all = sweep(recall, entity(), request, {}, {}, {});
  ASSERT_TRUE(all.ok()) << all.status().to_string();
  ASSERT_EQ(all->size(), 2u);
  EXPECT_EQ((*all)[0].model.images, 18u);
  EXPECT_EQ((*all)[1].model.images, 17u);
  EXPECT_GT((*all)[0].model.mean_psnr_db, (*all)[1].model.mean_psnr_db);
  EXPECT_EQ((*all)[0].model.mean_psnr_db, (*all)[0].copy_last.mean_psnr_db);
  EXPECT_EQ((*all)[0].model_bound_coverage.images.predictions, 0u);
  SweepOptions some;
  some.first = time_at(5);
  some.last = time_at(12);
  some.every = 3;
  const auto few = sweep(recall, entity(), request, some, {}, {});
  EXPECT_EQ((*few)[0].model.images, 3u) << "5, 8 and 11";
  some.every = 0;
  EXPECT_EQ(sweep(recall, entity(), request, some, {}, {}).status().code(),
            StatusCode::kInvalidArgument);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(sweep(recall, entity(), request, {}, {}, stop.get_token()).status().code(),
            StatusCode::kCancelled);
}

}  // namespace
}  // namespace engram::training
