// SPDX-License-Identifier: Apache-2.0
// Services over a replay: what they take, refuse and tell.
#include <gtest/gtest.h>

#include "memory/replay/running_replay.h"
#include "memory/replay_control.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/memory/replay/lived_memory.h"

namespace engram {
namespace {

using testing::lived_at;
using testing::LivedMemory;
using Kind = ReplayCommand::Kind;

/// A service over a replay.
Result<std::unique_ptr<memory::MemoryService>> serve(memory::Replay& replay,
                                                     memory::MemoryService::Options options = {}) {
  options.memory.mode = ltm::StoreMode::kLatest;
  options.below = replay.below(0);
  return memory::MemoryService::open(options, nullptr);
}

TEST(ReplayService, GoesOnPlayingAfterAStepThatItRefuses) {
  LivedMemory lived;
  lived.live(1);
  lived.end();
  for (const bool is_paused : {false, true}) {
    const auto replay =
        memory::Replay::open({lived.path}, nullptr, {.at = lived_at(100), .is_paused = is_paused});
    ASSERT_OK(replay);
    const auto service = serve(**replay);
    ASSERT_OK(service);
    const auto stepped = (*service)->commit(commit_of({.kind = Kind::kStep}));
    EXPECT_EQ(stepped.status().code(), StatusCode::kNotFound);
    EXPECT_EQ((*replay)->state().is_playing, !is_paused);
    const ltm::Query control = *ltm::Query::parse(replay_control_entity().to_string());
    EXPECT_EQ((*service)->query(control).status().code(), StatusCode::kNotFound);
  }
}

/// As a store does.
TEST(ReplayService, RedactsCommitsAndBoundsAnswers) {
  LivedMemory lived;
  lived.live(1);
  lived.end();
  const auto replay =
      memory::Replay::open({lived.path}, nullptr, {.at = lived_at(0.9), .is_paused = true});
  ASSERT_OK(replay);
  ltm::EntityRule rule{"cameras", *ltm::EntityPattern::parse("Vision"), {}, {}, {}, {}};
  rule.redact = ltm::testing::marker_redaction(lived.folder.path());
  memory::MemoryService::Options options;
  options.redacting = {rule};
  options.max_answer_bytes = 4'000;
  const auto service = serve(**replay, options);
  ASSERT_OK(service);
  const idf::Data value = idf::Dict{{"image", ltm::testing::image_with_secret(64, 48, 20, 5)}};
  const auto admission = (*service)->commit(
      {{{*ltm::MemoryId::parse("Vision/RGB/head/cam"), lived_at(0.9), {{value, {}}}}}});
  ASSERT_OK(admission);
  const idf::Data& told = admission->snapshots.at(0)->instances.at(0).data;
  EXPECT_FALSE(ltm::testing::has_secret(told.at("image")->get<idf::NdArray>()));
  EXPECT_OK((*service)->query(*ltm::Query::parse("Robot @ latest")));
  EXPECT_EQ((*service)->query(*ltm::Query::parse("Robot @ all")).status().code(),
            StatusCode::kResourceExhausted);
}

TEST(ReplayService, ObeysNoCommandWhoseCommitIsRefused) {
  LivedMemory lived;
  lived.live(1);
  lived.end();
  const auto replay =
      memory::Replay::open({lived.path}, nullptr, {.at = lived_at(0.1), .is_paused = true});
  ASSERT_OK(replay);
  memory::MemoryService::Options options;
  options.memory.max_waiting_bytes = 1;
  options.store_interval = std::chrono::hours(1);
  const auto service = serve(**replay, options);
  ASSERT_OK(service);
  // What the replay itself tells of its clock waits already.
  const auto seek = (*service)->commit(commit_of({.kind = Kind::kSeek, .time = lived_at(0.5)}), {});
  EXPECT_EQ(seek.status().code(), StatusCode::kResourceExhausted);
  EXPECT_EQ((*replay)->state().now, lived_at(0.1));
  EXPECT_EQ((*replay)->state().jumps, 0u);
}

}  // namespace
}  // namespace engram
