// SPDX-License-Identifier: Apache-2.0
#include "training/consolidate.h"

#include <gtest/gtest.h>

#include "encoders/load_model.h"
#include "ltm/recall/recall.h"
#include "ltm/recording/recorder.h"
#include "tests/training/moving_scene.h"
#include "training/metrics.h"

namespace engram::training {
namespace {

using engram::testing::quick_options;
using engram::testing::scene_source;
using engram::testing::ScratchPath;

ltm::MemoryId id(const std::string& text) {
  return *ltm::MemoryId::parse(text);
}

void record(const std::filesystem::path& store, const std::string& entity, int first, int count) {
  auto recorder = ltm::Recorder::open(store, {});
  ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
  const auto source = scene_source(first + count);
  for (int i = first; i < first + count; ++i) {
    const Time time = source.times[static_cast<size_t>(i)];
    const ltm::Snapshot snapshot{id(entity), time, {{engram::testing::scene_at(i), {}}}};
    ASSERT_TRUE(recorder->commit({{snapshot}}).ok());
  }
  ASSERT_TRUE(recorder->close().ok());
}

ConsolidateOptions options() {
  ConsolidateOptions options;
  options.train = quick_options(20);
  return options;
}

TEST(Consolidate, PublishesLatentsThatAQueryDecodes) {
  const ScratchPath store("consolidate");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  const auto report = consolidate(store.path(), options(), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  ASSERT_EQ(report->entities.size(), 1u);
  const EntityReport& entity = report->entities[0];
  EXPECT_EQ(entity.skipped_reason, "");
  EXPECT_EQ(entity.snapshots, 20u);
  EXPECT_EQ(entity.model_version, 1);
  EXPECT_LT(entity.latent_bytes, entity.raw_bytes);
  EXPECT_GT(entity.model_bytes, 0u);

  ltm::Recall recall(*ltm::StoreReader::open(store.path()), encoders::load_model);
  ltm::Recall::Options prefer_latent;
  prefer_latent.prefer = ltm::Recall::Prefer::kLatent;
  const auto answer = recall.query(*ltm::Query::parse("Test @ all"), prefer_latent);
  ASSERT_TRUE(answer.ok()) << answer.status().to_string();
  const auto& snapshots = answer->entities()[0]->snapshots;
  ASSERT_EQ(snapshots.size(), 20u);
  EXPECT_EQ(snapshots[5].source, ltm::Source::kReconstructed);
  const auto error = compare(engram::testing::scene_at(5), snapshots[5].instances[0].data);
  EXPECT_DOUBLE_EQ(error->image_mse, snapshots[5].instances[0].error->image_mse);
}

TEST(Consolidate, SkipsWhatHasNothingNewUnlessForced) {
  const ScratchPath store("nothing_new");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  ASSERT_TRUE(consolidate(store.path(), options(), {}, {}).ok());
  EXPECT_EQ(consolidate(store.path(), options(), {}, {})->entities[0].skipped_reason,
            "nothing new");
  record(store.path(), "Test/Scene/sim/square", 20, 4);
  EXPECT_EQ(consolidate(store.path(), options(), {}, {})->entities[0].model_version, 2);
  auto forced = options();
  forced.force = true;
  EXPECT_EQ(consolidate(store.path(), forced, {}, {})->entities[0].model_version, 3);
}

TEST(Consolidate, SkipsSmallEntitiesAndTakesOnlyThoseAskedFor) {
  const ScratchPath store("filter");
  record(store.path(), "Test/Scene/sim/large", 0, 17);
  record(store.path(), "Test/Scene/sim/small", 0, 3);
  auto chosen = options();
  chosen.entities = {"Test/Scene/sim/small"};
  const auto report = consolidate(store.path(), chosen, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  ASSERT_EQ(report->entities.size(), 1u);
  EXPECT_EQ(report->entities[0].skipped_reason, "3 recorded snapshots, needs 16");
  chosen.entities = {"Nothing"};
  EXPECT_EQ(consolidate(store.path(), chosen, {}, {}).status().code(), StatusCode::kNotFound);
}

TEST(Consolidate, LeavesTheStoreAsItWasWhenStopped) {
  const ScratchPath store("stopped_job");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  std::stop_source stop;
  const ProgressSink sink = [&](const Progress& progress) {
    if (progress.what.starts_with("encode")) stop.request_stop();
  };
  const auto before = ltm::read_manifest(store.path())->generation;
  EXPECT_EQ(consolidate(store.path(), options(), sink, stop.get_token()).status().code(),
            StatusCode::kCancelled);
  EXPECT_EQ(ltm::read_manifest(store.path())->generation, before);
}

}  // namespace
}  // namespace engram::training
