// SPDX-License-Identifier: Apache-2.0
#include "training/evaluate.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "ltm/recording/recorder.h"
#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "tests/training/moving_scene.h"
#include "training/consolidate.h"

namespace engram::training {
namespace {

using engram::testing::ScratchPath;

const char* const kEntity = "Test/Scene/sim/square";

void record_and_consolidate(const std::filesystem::path& store) {
  const auto source = engram::testing::scene_source(60, 3);
  auto recorder = ltm::Recorder::open(store, {});
  ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
  for (size_t i = 0; i < source.times.size(); ++i)
    ASSERT_TRUE(
        recorder
            ->commit({{{*ltm::MemoryId::parse(kEntity), source.times[i], {{*source.read(i), {}}}}}})
            .ok());
  ASSERT_TRUE(recorder->close().ok());
  ConsolidateOptions options;
  options.train = engram::testing::quick_options(20);
  options.train.hold_out_recordings = 1;
  const auto report = consolidate(store, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
}

TEST(Evaluate, KeepsWhatTheModelWasTrainedOnApart) {
  const ScratchPath store("evaluate");
  record_and_consolidate(store.path());
  const auto report = evaluate(store.path(), {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  ASSERT_EQ(report->entities.size(), 1u);
  const EntityEvaluation& entity = report->entities[0];
  EXPECT_EQ(entity.snapshots, 60u);
  EXPECT_EQ(entity.reconstruction.images, 40u);
  EXPECT_EQ(entity.left_out_reconstruction.images, 20u);
  // Of 20 snapshots 18 have one before and one after; the last 3 are held out from the dynamics.
  const auto counted = [&](Known known, size_t horizon) {
    return entity.prediction[static_cast<size_t>(known)][horizon].model.images;
  };
  EXPECT_EQ(counted(Known::kTrained, 0), 2 * 15u);
  EXPECT_EQ(counted(Known::kHeldOut, 0), 2 * 3u);
  EXPECT_EQ(counted(Known::kLeftOutRecording, 0), 18u);
  EXPECT_EQ(counted(Known::kLeftOutRecording, 1), 17u);
}

TEST(Evaluate, CountsSnapshotsWithoutTruth) {
  const ScratchPath store("dropped");
  record_and_consolidate(store.path());
  ASSERT_TRUE(ltm::drop_recorded(store.path(), *ltm::MemoryId::parse(kEntity), {}).ok());
  const auto report = evaluate(store.path(), {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->entities[0].not_evaluated, 60u);
  EXPECT_EQ(report->entities[0].reconstruction.images, 0u);
}

TEST(Evaluate, BecomesJsonWithNullForWhatIsMissing) {
  EvalReport report;
  report.entities.push_back({});
  report.entities[0].entity = *ltm::MemoryId::parse(kEntity);
  report.entities[0].reconstruction.rmse = std::numeric_limits<double>::quiet_NaN();
  report.entities[0].prediction[0].push_back({1, {}, {}});
  const auto json = to_json(report);
  EXPECT_EQ(json["entities"][0]["entity"], kEntity);
  EXPECT_TRUE(json["entities"][0]["reconstruction"]["rmse"].is_null());
  EXPECT_EQ(json["entities"][0]["prediction"]["trained on"][0]["horizon"], 1);
}

}  // namespace
}  // namespace engram::training
