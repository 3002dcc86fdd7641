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

/// A store of `recordings` recordings of 20 values each.
void record(const std::filesystem::path& store, int recordings) {
  auto recorder = ltm::Recorder::open(store, {});
  ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
  const auto source = engram::testing::scene_source(20 * recordings, recordings);
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

TEST(Crossval, MeasuresEachRecordingByAModelThatNeverSawIt) {
  const ScratchPath store("crossval");
  record(store.path(), 3);
  const auto report = crossval(store.path(), options(60));
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  ASSERT_EQ(report->folds.size(), 3u);
  for (const CrossvalFold& fold : report->folds) {
    EXPECT_EQ(fold.snapshots, 20u);
    EXPECT_EQ(fold.trained.images, 40u);
    EXPECT_EQ(fold.left_out.images, 20u);
    EXPECT_GT(fold.left_out_bytes, 0);
    for (const auto& way : fold.prediction) {
      EXPECT_EQ(way[0].images, 18u);
      EXPECT_EQ(way[1].images, 17u);
    }
  }
  EXPECT_EQ(report->all.snapshots, 60u);
  EXPECT_EQ(report->all.left_out.images, 60u);
  EXPECT_NE(report->folds[0].first, report->folds[1].first);
  // The square moves by two pixels each time, the joints turn evenly.
  const auto& copied = report->all.prediction[static_cast<size_t>(Predicting::kCopyLast)];
  EXPECT_GT(copied[0].mean_psnr_db, copied[1].mean_psnr_db);
  const auto& linear = report->all.prediction[static_cast<size_t>(Predicting::kLinear)];
  EXPECT_LT(linear[0].rmse, copied[0].rmse);
  EXPECT_EQ(to_json(*report).at("folds").size(), 3u);
}

TEST(Crossval, LeavesNothingInTheStore) {
  const ScratchPath store("crossval_clean");
  record(store.path(), 2);
  const auto before = ltm::read_manifest(store.path())->generation;
  auto chosen = options(2);
  chosen.most_folds = 1;
  const auto report = crossval(store.path(), chosen);
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->folds.size(), 1u);
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
