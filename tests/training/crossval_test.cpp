// SPDX-License-Identifier: Apache-2.0
#include "training/crossval.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

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

/// Of 20 values, 18 are one and 17 two ahead of two others.
void expect_all_predictions(const std::array<Quality, kAhead>& prediction) {
  EXPECT_EQ(prediction[0].images, 18u);
  EXPECT_EQ(prediction[1].images, 17u);
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
    EXPECT_EQ(variant.trained.images, 40u);
    EXPECT_EQ(variant.left_out.images, 20u);
    EXPECT_GT(variant.left_out_bytes, 0);
    EXPECT_EQ(variant.similarity.snapshots, 20u);
    EXPECT_EQ(variant.similarity.others, 59u);
    expect_all_predictions(variant.prediction);
    for (const auto& way : fold.baselines) expect_all_predictions(way);
  }
  EXPECT_EQ(report->all.snapshots, 60u);
  EXPECT_EQ(report->all.variants[0].left_out.images, 60u);
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

TEST(Crossval, TrainsOnWhatLiesBetweenMeasuredSnapshots) {
  const ScratchPath store("crossval_every");
  record(store.path(), 2);
  auto chosen = options(20);
  chosen.every = std::chrono::milliseconds(400);
  chosen.folds = {1};
  const auto report = crossval(store.path(), chosen);
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const CrossvalFold& fold = report->folds.front();
  EXPECT_EQ(fold.snapshots, 10u);
  EXPECT_EQ(fold.variants[0].left_out.images, 10u);
  EXPECT_EQ(fold.variants[0].trained.images, 10u);
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
  chosen.every = -std::chrono::milliseconds(1);
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
  for (size_t ahead = 0; ahead < kAhead; ++ahead) {
    const Coverage& told = variant.foresight[ahead].images;
    EXPECT_EQ(told.predictions, 128 - ahead);
    // The square goes on as it did: about nine of ten are within.
    EXPECT_GT(told.share(), 0.7);
    EXPECT_GT(told.expected, 20);
    EXPECT_LE(told.mean_bound, told.expected);
  }
  const auto json = to_json(*report);
  const auto& bound = json.at("all").at("variants").at("rate").at("bound");
  ASSERT_EQ(bound.size(), kAhead);
  EXPECT_EQ(bound[1].at("images").at("within"), variant.foresight[1].images.within);
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
    EXPECT_EQ(variant.left_out.images, 40u);
    EXPECT_NEAR(variant.reconstruction_gap_db(),
                variant.trained.mean_psnr_db - variant.left_out.mean_psnr_db, 1e-9);
    const auto& one = json.at("all").at("variants").at(std::string(to_string(variant.variant)));
    EXPECT_EQ(one.at("gain_over_copy_last_db")[1].get<double>(), report->all.gain_db(i, 1));
    if (i > 0) {
      EXPECT_NE(variant.left_out.pooled_psnr_db, report->all.variants[0].left_out.pooled_psnr_db);
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
