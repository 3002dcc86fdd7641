// SPDX-License-Identifier: Apache-2.0
#include "training/measure/crossval.h"
#include "training/quality/quality_metrics.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "ltm/recording/recorder.h"
#include "tests/training/moving_scene.h"

namespace engram::training {
namespace {

using engram::testing::quick_options;
using engram::testing::ScratchPath;

/// A store of `recordings` recordings of 20 values, or so many, each.
void record(const std::filesystem::path& store, int recordings, int each = 20) {
  auto recorder = ltm::Recorder::open(store, {});
  ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
  const auto source = engram::testing::scene_source(each * recordings, recordings);
  const auto entity = *ltm::MemoryId::parse("Test/Scene/sim/square");
  for (size_t i = 0; i < source.times.size(); ++i) {
    const ltm::Snapshot snapshot{entity, source.times[i], {{*source.read(i), {}}}};
    ASSERT_TRUE(recorder->commit({{snapshot}}).ok());
  }
  ASSERT_TRUE(recorder->close().ok());
}

CrossvalOptions options(int steps) {
  CrossvalOptions options;
  options.train = quick_options(steps);
  options.entity = "Test/Scene/sim/square";
  return options;
}

/// Of `values`, all but two are one and all but three two ahead of two others.
void expect_predictions(const std::vector<Quality>& prediction, size_t values) {
  ASSERT_EQ(prediction.size(), kMinHorizon);
  EXPECT_EQ(prediction[0].images, values - 2);
  EXPECT_EQ(prediction[1].images, values - 3);
}

TEST(Crossval, MeasuresEachRecordingByAModelThatNeverSawIt) {
  const ScratchPath store("crossval");
  record(store.path(), 3);
  const auto report = crossval(store.path(), options(60));
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  ASSERT_EQ(report->folds.size(), 3u);
  for (const CrossvalFold& fold : report->folds) {
    EXPECT_EQ(fold.snapshots, 20u);
    ASSERT_EQ(fold.variants.size(), 1u);
    const VariantQuality& variant = fold.variants[0];
    EXPECT_EQ(variant.variant, encoders::TrainingVariant::kRateAware);
    EXPECT_EQ(variant.latents.trained.images, 40u);
    EXPECT_EQ(variant.latents.left_out.images, 20u);
    EXPECT_GT(variant.latents.left_out_bytes, 0);
    EXPECT_EQ(variant.similarity.snapshots, 20u);
    EXPECT_EQ(variant.similarity.others, 59u);
    expect_predictions(variant.prediction, 20);
    for (const auto& way : fold.baselines) expect_predictions(way, 20);
  }
  EXPECT_EQ(report->all.snapshots, 60u);
  EXPECT_EQ(report->all.variants[0].latents.left_out.images, 60u);
  EXPECT_EQ(report->all.variants[0].similarity.snapshots, 60u);
  EXPECT_NE(report->folds[0].first, report->folds[1].first);
  // The square moves by two pixels each time, the joints turn evenly.
  const auto& copied = report->all.baselines[static_cast<size_t>(Baseline::kCopyLast)];
  EXPECT_GT(copied[0].mean_psnr_db, copied[1].mean_psnr_db);
  const auto& linear = report->all.baselines[static_cast<size_t>(Baseline::kLinear)];
  EXPECT_LT(linear[0].rmse, copied[0].rmse);
  const auto& flow = report->all.baselines[static_cast<size_t>(Baseline::kFlow)];
  EXPECT_GT(flow[0].mean_psnr_db, copied[0].mean_psnr_db + 1);
  EXPECT_EQ(flow[0].rmse, linear[0].rmse);
  EXPECT_EQ(to_json(*report).at("folds").size(), 3u);
}

TEST(Crossval, MeasuresStructuralSimilarityOfEveryPrediction) {
  const ScratchPath store("crossval_ssim");
  record(store.path(), 2);
  auto chosen = options(20);
  chosen.folds = {1};
  const auto report = crossval(store.path(), chosen);
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const auto source = engram::testing::scene_source(40, 2);
  double sum = 0;
  for (size_t i = 2; i < 20; ++i) sum += *mean_ssim(*source.read(i), *source.read(i - 1));
  const auto& copied = report->all.baselines[static_cast<size_t>(Baseline::kCopyLast)];
  EXPECT_NEAR(copied[0].mean_ssim, sum / 18, 1e-9);
  EXPECT_LT(copied[0].mean_ssim, 1);
  const double left_out = report->all.variants[0].latents.left_out.mean_ssim;
  EXPECT_GT(left_out, -1);
  EXPECT_LE(left_out, 1);
  EXPECT_EQ(to_json(*report).at("all").at("baselines").at("copy-last")[0].at("mean_ssim"),
            copied[0].mean_ssim);
}

TEST(Crossval, MeasuresWhatResidualsAddBesideLatentsAlone) {
  const ScratchPath store("crossval_corrected");
  record(store.path(), 2);
  auto chosen = options(30);
  chosen.folds = {2};
  chosen.bound_db = 30;
  const auto report = crossval(store.path(), chosen);
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const Reconstruction& alone = report->all.variants[0].latents;
  const Reconstruction& corrected = report->all.variants[0].corrected;
  EXPECT_EQ(corrected.left_out.images, 20u);
  EXPECT_EQ(corrected.trained.images, 20u);
  EXPECT_LT(alone.left_out.mean_psnr_db, 30);
  EXPECT_GE(corrected.left_out.mean_psnr_db, 30);
  EXPECT_GT(corrected.left_out_bytes, alone.left_out_bytes);
  const auto json = to_json(*report);
  EXPECT_EQ(json.at("bound_db"), 30);
  EXPECT_EQ(json.at("all").at("variants").at("rate").at("corrected").at("left_out_bytes"),
            corrected.left_out_bytes);
  chosen.bound_db = 5;
  EXPECT_EQ(crossval(store.path(), chosen).status().code(), StatusCode::kInvalidArgument);
}

TEST(Crossval, PredictsAsFarAheadAsItIsTold) {
  const ScratchPath store("crossval_ahead");
  record(store.path(), 2);
  auto chosen = options(20);
  chosen.folds = {1};
  chosen.max_horizon = 7;
  const auto report = crossval(store.path(), chosen);
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  for (const CrossvalFold* fold : {&report->folds.front(), &report->all}) {
    ASSERT_EQ(fold->variants[0].prediction.size(), 7u);
    for (const auto& way : fold->baselines) {
      ASSERT_EQ(way.size(), 7u);
      for (size_t ahead = 0; ahead < 7; ++ahead) EXPECT_EQ(way[ahead].images, 18 - ahead);
    }
  }
  EXPECT_EQ(to_json(*report).at("all").at("baselines").at("flow").size(), 7u);
  chosen.max_horizon = 1;
  EXPECT_EQ(crossval(store.path(), chosen).status().code(), StatusCode::kInvalidArgument);
}

TEST(Crossval, TrainsOnWhatLiesBetweenMeasuredSnapshots) {
  const ScratchPath store("crossval_every");
  record(store.path(), 2);
  auto chosen = options(20);
  chosen.spacing = std::chrono::milliseconds(400);
  chosen.folds = {1};
  const auto report = crossval(store.path(), chosen);
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const CrossvalFold& fold = report->folds.front();
  EXPECT_EQ(fold.snapshots, 10u);
  EXPECT_EQ(fold.variants[0].latents.left_out.images, 10u);
  EXPECT_EQ(fold.variants[0].latents.trained.images, 10u);
  EXPECT_EQ(fold.variants[0].prediction[0].images, 8u);
  // Predicting twice as far is harder for who copies.
  const auto near = crossval(store.path(), [] {
    auto every_one = options(20);
    every_one.folds = {1};
    return every_one;
  }());
  ASSERT_TRUE(near.ok()) << near.status().to_string();
  const auto copied = static_cast<size_t>(Baseline::kCopyLast);
  EXPECT_LT(fold.baselines[copied][0].mean_psnr_db,
            near->folds.front().baselines[copied][0].mean_psnr_db);
  chosen.spacing = -std::chrono::milliseconds(1);
  EXPECT_EQ(crossval(store.path(), chosen).status().code(), StatusCode::kInvalidArgument);
}

TEST(Crossval, CountsHowOftenErrorsOfLeftOutRecordingsAreWithinTheirBounds) {
  const ScratchPath store("crossval_bounds");
  // 15 % of 130 are 20 windows, ten of which calibrate.
  record(store.path(), 2, 130);
  auto chosen = options(20);
  chosen.folds = {1};
  const auto report = crossval(store.path(), chosen);
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const VariantQuality& variant = report->all.variants[0];
  for (size_t ahead = 0; ahead < kMinHorizon; ++ahead) {
    const Coverage& told = variant.bound_coverage[ahead].images;
    EXPECT_EQ(told.predictions, 128 - ahead);
    // The square goes on as it did: about nine of ten are within.
    EXPECT_GT(told.share(), 0.7);
    EXPECT_GT(told.expected, 20);
    EXPECT_LE(told.mean_bound, told.expected);
  }
  const auto json = to_json(*report);
  const auto& bound = json.at("all").at("variants").at("rate").at("bound");
  ASSERT_EQ(bound.size(), kMinHorizon);
  EXPECT_EQ(bound[1].at("images").at("within"), variant.bound_coverage[1].images.within);
}

/// Two recordings of images that are dark or bright as chance has it, which link to an entity that
/// knows how bright the next one is.
void record_announced(const std::filesystem::path& store) {
  auto recorder = ltm::Recorder::open(store, {});
  ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
  const auto image = *ltm::MemoryId::parse("Test/Scene/sim/square");
  const auto announcement = *ltm::MemoryId::parse("Test/Scene/sim/announcement");
  const auto times = engram::testing::scene_source(80, 2).times;
  std::mt19937 random(3);
  std::vector<int> levels;
  for (size_t i = 0; i <= times.size(); ++i) levels.push_back(random() % 2 == 0 ? 80 : 170);
  for (size_t i = 0; i < times.size(); ++i) {
    idf::Dict seen, next;
    const auto grey = static_cast<uint8_t>(levels[i]);
    seen.set("image", idf::NdArray::take<uint8_t>({16, 16, 1}, std::vector<uint8_t>(256, grey)));
    seen.set("announced", announcement.at(times[i]).to_string());
    next.set("next", static_cast<double>(levels[i + 1]));
    const ltm::Snapshot told{announcement, times[i], {{std::move(next), {}}}};
    const ltm::Snapshot snapshot{image, times[i], {{std::move(seen), {}}}};
    ASSERT_TRUE(recorder->commit({{told, snapshot}}).ok());
  }
  ASSERT_TRUE(recorder->close().ok());
}

TEST(Crossval, MeasuresWhatItTellsToKnowWhatCameOfTheCondition) {
  const ScratchPath store("crossval_planned");
  record_announced(store.path());
  auto chosen = options(600);
  chosen.folds = {1};
  const auto report = crossval(store.path(), chosen);
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const VariantQuality& variant = report->all.variants[0];
  expect_predictions(variant.planned, 40);
  // The condition announces the next image: known or planned, it tells more than no condition.
  const double copied =
      report->all.baselines[static_cast<size_t>(Baseline::kCopyLast)][0].pooled_psnr_db;
  EXPECT_GT(variant.prediction[0].pooled_psnr_db, copied + 3);
  EXPECT_GT(variant.planned[0].pooled_psnr_db, copied + 3);
  EXPECT_NE(variant.planned[0].pooled_psnr_db, variant.prediction[0].pooled_psnr_db);
  const auto json = to_json(*report).at("all").at("variants").at("rate").at("planned");
  ASSERT_EQ(json.size(), kMinHorizon);
  EXPECT_EQ(json.at(1).at("images"), 37);
}

TEST(Crossval, PutsVariantsBesideEachOther) {
  const ScratchPath store("crossval_variants");
  record(store.path(), 2);
  auto chosen = options(30);
  chosen.variants.assign(encoders::kTrainingVariants.begin(), encoders::kTrainingVariants.end());
  const auto report = crossval(store.path(), chosen);
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  ASSERT_EQ(report->all.variants.size(), 4u);
  const auto json = to_json(*report);
  for (size_t i = 0; i < 4; ++i) {
    const VariantQuality& variant = report->all.variants[i];
    EXPECT_EQ(variant.variant, chosen.variants[i]);
    EXPECT_EQ(variant.latents.left_out.images, 40u);
    EXPECT_NEAR(variant.latents.gap_db(),
                variant.latents.trained.mean_psnr_db - variant.latents.left_out.mean_psnr_db, 1e-9);
    const auto& one = json.at("all").at("variants").at(std::string(to_string(variant.variant)));
    EXPECT_EQ(one.at("gain_over_copy_last_db")[1].get<double>(), report->all.gain_db(i, 1));
    if (i > 0) {
      EXPECT_NE(variant.latents.left_out.pooled_psnr_db,
                report->all.variants[0].latents.left_out.pooled_psnr_db);
    }
  }
}

TEST(Crossval, NeedsEachVariantOnce) {
  auto chosen = options(2);
  chosen.variants.push_back(encoders::TrainingVariant::kRateAware);
  EXPECT_EQ(chosen.validate().code(), StatusCode::kInvalidArgument);
  chosen.variants.clear();
  EXPECT_EQ(chosen.validate().code(), StatusCode::kInvalidArgument);
}

TEST(Crossval, LeavesNothingInTheStore) {
  const ScratchPath store("crossval_clean");
  record(store.path(), 2);
  const auto before = ltm::read_manifest(store.path())->generation;
  auto chosen = options(2);
  chosen.folds = {1};
  chosen.folds = {2};
  std::vector<size_t> told;
  const auto report =
      crossval(store.path(), chosen, {}, {}, [&](const CrossvalFold& fold, size_t i) {
        told.push_back(i);
        EXPECT_EQ(fold.variants.size(), 1u);
      });
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->folds.size(), 1u);
  EXPECT_EQ(told, std::vector<size_t>{2});
  for (const std::vector<size_t>& none : {std::vector<size_t>{0}, {1, 1}, {3}}) {
    chosen.folds = none;
    EXPECT_EQ(crossval(store.path(), chosen).status().code(), StatusCode::kInvalidArgument);
  }
  EXPECT_EQ(ltm::read_manifest(store.path())->generation, before);
  EXPECT_TRUE(std::filesystem::is_empty(store.path() / "tmp"));
}

TEST(Crossval, NeedsTwoRecordingsAndOneEntity) {
  const ScratchPath store("crossval_few");
  record(store.path(), 1);
  EXPECT_EQ(crossval(store.path(), options(2)).status().code(), StatusCode::kInvalidArgument);
  auto chosen = options(2);
  chosen.entity = "Nothing";
  EXPECT_EQ(crossval(store.path(), chosen).status().code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace engram::training
