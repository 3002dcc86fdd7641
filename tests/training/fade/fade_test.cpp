// SPDX-License-Identifier: Apache-2.0
// Memories that fade: real codecs on a small scene, from plan to disk.
#include "training/fade/fade.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>
#include <thread>

#include "encoders/load_model.h"
#include "ltm/forgetting/carry_out.h"
#include "ltm/forgetting/plan_forgetting.h"
#include "ltm/recall/recall.h"
#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_check.h"
#include "tests/training/recorded_scene.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::ScratchPath;

constexpr int kCount = 48;
/// Too few chains for references, whose key frames are no part of what fades.
constexpr int kChainRows = 16;
constexpr double kBoundDb = 42;

/// A scene that moves, with texture that costs bytes, and numbers.
idf::Data textured_at(int index) {
  std::vector<uint8_t> pixels(48 * 64 * 3);
  std::mt19937 random(5);
  for (size_t i = 0; i < pixels.size(); ++i) {
    const int x = static_cast<int>(i / 3 % 64), y = static_cast<int>(i / 3 / 64);
    const int wave = 60 * ((x + index) / 8 % 2) + 40 * (y / 8 % 2);
    pixels[i] = static_cast<uint8_t>(60 + wave + static_cast<int>(random() % 24));
  }
  return idf::Dict{{"image", idf::NdArray::take({48, 64, 3}, std::move(pixels))},
                   {"joint", std::sin(0.1 * index)}};
}

class FadeTest : public ::testing::Test {
 protected:
  FadeTest() : store_("fade") {
    auto recorder = ltm::Recorder::open(store_.path(), {});
    for (int i = 0; i < kCount; ++i) {
      recorded_.push_back(textured_at(i));
      const ltm::Snapshot snapshot{entity_, time(i), {{recorded_.back(), {}}}};
      EXPECT_TRUE(recorder->commit({{snapshot}}).ok());
    }
    EXPECT_TRUE(recorder->close().ok());
    ConsolidateOptions options;
    options.representation.kind = Representation::kVideo;
    options.representation.bound_db = kBoundDb;
    options.representation.video_effort = 1;
    options.access = Duration::zero();
    options.train = engram::testing::quick_options(1);
    options.train.chain_rows = kChainRows;
    const auto report = consolidate(store_.path(), options, {}, {});
    EXPECT_TRUE(report.ok()) << report.status().to_string();
  }

  static Time time(int index) { return time_from_ns(int64_t{index} * 200'000'000); }

  void drop_recorded() { ASSERT_TRUE(ltm::drop_recorded(store_.path(), entity_, {}).ok()); }

  ltm::FadeSet what(int first, int end, std::optional<double> psnr_db) {
    ltm::FadingSnapshots part{psnr_db, {}};
    for (int i = first; i < end; ++i) part.times.insert(time(i));
    return {{entity_, {part}}};
  }

  ltm::EntityFadeReport fade_some(int first, int end, std::optional<double> psnr_db,
                                  const std::stop_token& stop = {}) {
    const auto report = fade(store_.path(), what(first, end, psnr_db), {}, stop);
    EXPECT_TRUE(report.ok()) << report.status().to_string();
    return report.ok() ? report->entities.at(entity_) : ltm::EntityFadeReport();
  }

  /// Every snapshot as an answer has it.
  std::vector<ltm::SnapshotResult> answers() {
    ltm::Recall recall(*ltm::StoreReader::open(store_.path()), encoders::load_model);
    const auto found = recall.query(ltm::Query::of_entity(entity_, ltm::select::All{}), {});
    EXPECT_TRUE(found.ok()) << found.status().to_string();
    return found.ok() ? found->entities().front()->snapshots : std::vector<ltm::SnapshotResult>();
  }

  /// The real error of an answer.
  ltm::MeasuredError real_error(const ltm::SnapshotResult& answer) {
    const auto index = static_cast<size_t>(to_ns(answer.time) / 200'000'000);
    return *compare(recorded_[index], answer.instances.front().data);
  }

  uint64_t latent_bytes() {
    const auto reader = *ltm::StoreReader::open(store_.path());
    uint64_t bytes = 0;
    for (const ltm::SnapshotEntry& entry : **reader->index(entity_)) {
      const auto latents = *reader->read_latent(entity_, entry);
      const ltm::Latent& latent = latents.instances.front().latent;
      if (latent.place.index == 0) bytes += latent.code.size();
    }
    return bytes;
  }

  void expect_whole() {
    const auto report = ltm::check_store(store_.path(), {}, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().to_string();
    for (const ltm::Finding& finding : report->findings) ADD_FAILURE() << finding.what;
  }

  ltm::MemoryId entity_ = id("Vision/RGB/head/cam");
  ScratchPath store_;
  std::vector<idf::Data> recorded_;
};

TEST_F(FadeTest, FromWhatWasRecordedItKeepsWhatItPromises) {
  const uint64_t before = latent_bytes();
  const ltm::EntityFadeReport report = fade_some(0, kCount, 30);
  EXPECT_EQ(report.faded, kCount);
  EXPECT_EQ(report.bytes_before, before);
  EXPECT_EQ(report.bytes_after, latent_bytes());
  EXPECT_LT(latent_bytes(), before * 6 / 10);
  const auto all = answers();
  ASSERT_EQ(all.size(), kCount);
  for (const ltm::SnapshotResult& answer : all) {
    EXPECT_EQ(answer.source, ltm::Source::kReconstructed) << "what was recorded is gone";
    const ltm::MeasuredError real = real_error(answer);
    EXPECT_GE(psnr_db(real.image_mse), 30);
    const ltm::MeasuredError& told = *answer.instances[0].error;
    EXPECT_GE(told.image_mse, real.image_mse);
    EXPECT_LE(told.image_mse, real.image_mse * 1.01) << "rounded up";
    EXPECT_GE(told.number_mse, real.number_mse);
    EXPECT_FALSE(answer.instances[0].bound.has_value()) << "it was measured";
  }
  expect_whole();
}

TEST_F(FadeTest, FromLatentsTheErrorIsBounded) {
  drop_recorded();
  const uint64_t before = latent_bytes();
  for (const double target : {36.0, 30.0}) {
    const ltm::EntityFadeReport report = fade_some(0, kCount, target);
    EXPECT_EQ(report.faded, kCount);
    EXPECT_GE(report.expected_db, target);
    double certain = std::numeric_limits<double>::infinity();
    for (const ltm::SnapshotResult& answer : answers()) {
      const ltm::MeasuredError real = real_error(answer);
      ASSERT_TRUE(answer.instances[0].bound.has_value());
      EXPECT_LE(real.image_mse, answer.instances[0].bound->image_mse);
      EXPECT_LE(real.number_mse, answer.instances[0].bound->number_mse + 1e-18);
      EXPECT_GE(psnr_db(real.image_mse), target) << "as was expected";
      certain = std::min(certain, psnr_db(answer.instances[0].bound->image_mse));
    }
    EXPECT_DOUBLE_EQ(report.certain_db, certain);
  }
  EXPECT_LT(latent_bytes(), before * 7 / 10);
  expect_whole();
}

TEST_F(FadeTest, AGistIsWhatWasRoughlyThere) {
  drop_recorded();
  const uint64_t before = latent_bytes();
  const ltm::EntityFadeReport report = fade_some(0, kCount, {});
  EXPECT_EQ(report.faded, kCount);
  EXPECT_LT(latent_bytes(), before / 4);
  const auto all = answers();
  ASSERT_EQ(all.size(), kCount);
  for (const ltm::SnapshotResult& answer : all) {
    const ltm::MeasuredError real = real_error(answer);
    EXPECT_GE(psnr_db(real.image_mse), 10);
    ASSERT_TRUE(answer.instances[0].bound.has_value());
    EXPECT_LE(real.image_mse, answer.instances[0].bound->image_mse);
    EXPECT_LE(real.number_mse, answer.instances[0].bound->number_mse) << "numbers stay";
  }
  EXPECT_EQ(fade_some(0, kCount, {}).faded, 0u);
  EXPECT_EQ(fade_some(0, kCount, 30).faded, 0u) << "nothing comes back";
  expect_whole();
}

TEST_F(FadeTest, KilledAtAnyMomentNothingIsLost) {
  for (int delay_ms = 0; delay_ms < 600; delay_ms += 60) {
    SCOPED_TRACE(delay_ms);
    const pid_t child = fork();
    if (child == 0) {
      const auto done = fade(store_.path(), what(0, kCount, 30), {}, {});
      _exit(done.ok() ? 0 : 1);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const auto all = answers();
    ASSERT_EQ(all.size(), kCount);
    for (const ltm::SnapshotResult& answer : all)
      EXPECT_GE(psnr_db(real_error(answer).image_mse), 30);
    expect_whole();
  }
  fade_some(0, kCount, 30);
  for (const ltm::SnapshotResult& answer : answers())
    EXPECT_EQ(answer.source, ltm::Source::kReconstructed) << "what was recorded went at last";
}

/// What is recorded goes only where its latents are as good as they say.
TEST_F(FadeTest, LatentsThatPromiseTooMuchDoNotStay) {
  {
    // Says that it has no error, and is so small that nothing is smaller.
    ASSERT_EQ(fade_some(0, kCount, {}).faded, kCount);
    std::vector<ltm::LatentSnapshot> gists;
    const auto faded = *ltm::StoreReader::open(store_.path());
    for (const ltm::SnapshotEntry& entry : **faded->index(entity_)) {
      gists.push_back(*faded->read_latent(entity_, entry));
      gists.back().instances[0].quality = {{1e-3, 0}};
    }
    auto recorder = ltm::Recorder::open(store_.path(), {});
    for (int i = 0; i < kCount; ++i)
      ASSERT_TRUE(
          recorder->commit({{{entity_, time(i), {{recorded_[static_cast<size_t>(i)], {}}}}}}).ok());
    ASSERT_TRUE(recorder->close().ok());
    ASSERT_TRUE(ltm::publish_latents(store_.path(), entity_, 1, gists).ok());
  }
  EXPECT_EQ(fade_some(0, kCount, 30).faded, kCount);
  for (const ltm::SnapshotResult& answer : answers())
    EXPECT_GE(psnr_db(real_error(answer).image_mse), 30);
}

TEST_F(FadeTest, ASecondTimeNothingChanges) {
  fade_some(0, kCount, 30);
  const auto first = answers();
  const uint64_t bytes = latent_bytes();
  const ltm::EntityFadeReport again = fade_some(0, kCount, 30);
  EXPECT_EQ(again.faded, 0u);
  EXPECT_EQ(answers(), first);
  EXPECT_EQ(latent_bytes(), bytes);
}

TEST_F(FadeTest, WhatIsCodedTogetherWithGoodOnesWaits) {
  drop_recorded();
  const auto reader = *ltm::StoreReader::open(store_.path());
  const auto entries = **reader->index(entity_);
  const int block =
      static_cast<int>(reader->read_latent(entity_, entries[0])->instances[0].latent.place.count);
  ASSERT_GT(block, 1);
  const auto before = answers();
  const ltm::EntityFadeReport report = fade_some(0, block - 1, 30);
  EXPECT_EQ(report.faded, 0u);
  EXPECT_EQ(report.waiting, static_cast<uint64_t>(block - 1));
  EXPECT_EQ(answers(), before);
  expect_whole();
}

TEST_F(FadeTest, StoppedItKeepsTheRestAsItWas) {
  drop_recorded();
  const auto before = answers();
  std::stop_source stop;
  stop.request_stop();
  const auto report = fade(store_.path(), what(0, kCount, 30), {}, stop.get_token());
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_TRUE(report->is_cancelled);
  EXPECT_EQ(answers(), before);
}

TEST_F(FadeTest, APlanOfItIsCarriedOutOnce) {
  ltm::ForgetOptions options;
  ltm::FadeStep& step = options.fade.emplace_back();
  step.rule.age = ltm::AgePolicy::Options{Duration(0)};
  step.psnr_db = 30;
  options.protection.newest = 0;
  const auto plan = [&] {
    ltm::Recall recall(*ltm::StoreReader::open(store_.path()), encoders::load_model);
    const ltm::AccessTable accesses;
    ltm::ForgetSource source(recall, accesses);
    return *ltm::plan_forgetting(source, options, *ltm::ForgetContext::of(store_.path()));
  };
  const ltm::ForgetPlan first = plan();
  EXPECT_EQ(first.fading(), kCount);
  const auto report = ltm::carry_out(store_.path(), first, {}, {}, {}, {.fade = fade});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->faded.faded(), kCount);
  EXPECT_LT(report->bytes_after, report->bytes_before / 2);
  EXPECT_EQ(plan().fading(), 0u);
}

}  // namespace
}  // namespace engram::training
