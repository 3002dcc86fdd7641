// SPDX-License-Identifier: Apache-2.0
#include "training/night/entity_costs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/training/recorded_scene.h"

namespace engram::training {
namespace {

using engram::testing::quick_consolidation;
using engram::testing::record;
using engram::testing::ScratchPath;

TEST(Consolidate, TellsWhatEachStageCost) {
  const ScratchPath store("costs");
  record(store.path(), "Test/Scene/sim/square", 0, 40);
  auto chosen = quick_consolidation();
  chosen.representation.kind = Representation::kVideo;
  chosen.representation.bound_db = 30;
  chosen.representation.video_effort = 1;
  chosen.access = {};
  const auto report = consolidate(store.path(), chosen, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const EntityReport& entity = report->entities[0];
  const EntityCosts& costs = entity.costs;
  EXPECT_EQ(costs.images_encoded, 40u);
  EXPECT_EQ(costs.video, "av1:effort=1,depth=10,spread=2");
  // One search for each chain.
  const auto chain = static_cast<size_t>(chosen.train.chain_rows);
  EXPECT_EQ(costs.encodes.size(), (40 + chain - 1) / chain);
  EXPECT_GE(costs.median_encodes(), 1);
  for (const Stage stage : {Stage::kPlan, Stage::kReading, Stage::kTraining, Stage::kVideo,
                            Stage::kVerification, Stage::kPublishing})
    EXPECT_GT(costs.stages.of(stage).seconds, 0) << to_string(stage);
  EXPECT_EQ(costs.stages.of(Stage::kResiduals).seconds, 0);
  EXPECT_EQ(costs.known_videos, 0u);
  // Each moment counts once, and the plan is made before. The last stage ends just after the
  // report.
  EXPECT_LE(costs.stages.total().seconds - costs.stages.of(Stage::kPlan).seconds,
            entity.seconds + 0.01);

  const auto again = consolidate(store.path(), chosen, {}, {});
  ASSERT_TRUE(again.ok()) << again.status().to_string();
  EXPECT_EQ(again->entities[0].skipped_reason, "nothing new");
  EXPECT_EQ(again->entities[0].costs.images_encoded, 0u);
  EXPECT_TRUE(std::isnan(again->entities[0].costs.mean_encodes()));
  EXPECT_GT(again->entities[0].costs.stages.of(Stage::kPlan).seconds, 0);

  chosen.force = true;
  const auto forced = consolidate(store.path(), chosen, {}, {});
  ASSERT_TRUE(forced.ok()) << forced.status().to_string();
  EXPECT_EQ(forced->entities[0].costs.known_videos, costs.encodes.size());
  EXPECT_TRUE(forced->entities[0].costs.encodes.empty());

  // What was made for a higher bound takes more bytes than it has to.
  chosen.representation.bound_db = 27;
  const auto lower = consolidate(store.path(), chosen, {}, {});
  ASSERT_TRUE(lower.ok()) << lower.status().to_string();
  EXPECT_EQ(lower->entities[0].costs.known_videos, 0u);
  EXPECT_EQ(lower->entities[0].costs.encodes.size(), costs.encodes.size());
}

}  // namespace
}  // namespace engram::training
