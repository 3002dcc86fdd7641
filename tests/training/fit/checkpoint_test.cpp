// SPDX-License-Identifier: Apache-2.0
#include "training/fit/checkpoint.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "ltm/core/file.h"
#include "tests/training/moving_scene.h"
#include "training/fit/trainer.h"

namespace engram::training {
namespace {

using engram::testing::content_of;
using engram::testing::quick_options;
using engram::testing::scene_source;
using engram::testing::ScratchPath;

constexpr int kSteps = 20;  // 17 of the autoencoder, 3 of the dynamics.

/// Trains on a scene of two recordings; keeps its state before every step.
class Training {
 public:
  explicit Training(const std::string& name) : directory_(name) {
    EXPECT_TRUE(make_directories(directory_.path()).ok());
    control_.checkpoint = directory_.path() / "kept";
    control_.checkpoint_interval = Duration(1);
  }

  /// The bytes of the model; empty where it was stopped, before the step `stop_at`; without a
  /// number of steps, after so many in this run.
  std::string run(int stop_at = std::numeric_limits<int>::max()) {
    const auto file = directory_.path() / "model.h5";
    std::filesystem::remove(file);
    std::stop_source stop;
    int calls = 0;
    const ProgressSink sink = [&](const Progress& progress) {
      if (++calls == 1) first_done = progress.done;
      const int steps = options.steps ? static_cast<int>(progress.done) + 1 : calls;
      if (steps >= stop_at) stop.request_stop();
    };
    const auto report =
        train_model(scene_source(count, 2), options, file, sink, stop.get_token(), control_);
    if (!report.ok()) {
      EXPECT_EQ(report.status().code(), StatusCode::kCancelled) << report.status().to_string();
      return "";
    }
    notes = report->notes;
    return content_of(file);
  }

  [[nodiscard]] const std::filesystem::path& kept() const { return control_.checkpoint; }
  [[nodiscard]] uint64_t key() const { return checkpoint_key(scene_source(count, 2), options); }

  int count = 40;
  TrainOptions options = quick_options(kSteps);
  std::vector<std::string> notes;
  uint64_t first_done = 0;

 private:
  ScratchPath directory_;
  TrainControl control_;
};

TEST(Checkpoint, AnInterruptedTrainingMakesTheSameModelAsOneThatWasNot) {
  const std::string whole = Training("whole").run();
  ASSERT_GT(whole.size(), 10000u);
  const std::vector<std::vector<int>> interruptions{{4}, {15}, {2, 10, 18}};
  for (const std::vector<int>& stops : interruptions) {
    Training training("interrupted");
    for (const int stop : stops) {
      EXPECT_EQ(training.run(stop), "") << stop;
      const auto kept = read_checkpoint(training.kept(), training.key());
      ASSERT_TRUE(kept.ok()) << kept.status().to_string();
      // 14 of 20 steps are the autoencoder's, one the dynamics', four the motion's.
      EXPECT_EQ(kept->phase, stop < 15   ? FitPhase::kAutoencoder
                             : stop < 17 ? FitPhase::kDynamics
                                         : FitPhase::kMotion);
    }
    EXPECT_TRUE(training.run() == whole) << "stopped first before step " << stops.front();
    EXPECT_NE(training.notes.front().find("went on"), std::string::npos);
    // What was done is not done again: only encoding is left.
    const auto done = read_checkpoint(training.kept(), training.key());
    ASSERT_TRUE(done.ok()) << done.status().to_string();
    EXPECT_EQ(done->share, 1.0);
    EXPECT_TRUE(training.run() == whole);
  }
}

TEST(Checkpoint, AnInterruptedTrainingSeesTheSameRowsWhereMemoryIsShort) {
  const auto make = [](Training& training, uint64_t snapshots) {
    training.count = 160;
    training.options.memory_bytes =
        snapshots * (engram::testing::kWidth * engram::testing::kHeight * 3 + 3 * sizeof(double));
  };
  Training one("short_memory"), other("shorter_memory"), interrupted("short_interrupted");
  make(one, 90);
  make(other, 60);
  make(interrupted, 90);
  const std::string whole = one.run();
  ASSERT_GT(whole.size(), 10000u);
  EXPECT_NE(one.notes.front().find("took turns"), std::string::npos) << one.notes.front();
  EXPECT_FALSE(other.run() == whole);
  for (const int stop : {6, 13}) EXPECT_EQ(interrupted.run(stop), "") << stop;
  EXPECT_TRUE(interrupted.run() == whole);
}

TEST(Checkpoint, OfOtherOptionsIsNotGoneOnFrom) {
  Training training("other");
  training.run(10);
  const uint64_t key = training.key();
  training.options.seed = 2;
  EXPECT_NE(training.key(), key);
  EXPECT_EQ(read_checkpoint(training.kept(), training.key()).status().code(),
            StatusCode::kFailedPrecondition);
  const std::string model = training.run();
  EXPECT_EQ(training.notes.size(), 0u);
  Training fresh("fresh");
  fresh.options.seed = 2;
  EXPECT_TRUE(model == fresh.run());
}

TEST(Checkpoint, KeyFollowsOptionsAndDataButNotTheTimeAllowed) {
  const auto source = scene_source(20);
  TrainOptions options;
  const uint64_t key = checkpoint_key(source, options);
  options.budget = std::chrono::hours(5);
  EXPECT_EQ(checkpoint_key(source, options), key);
  options.psnr_db = 37;
  EXPECT_NE(checkpoint_key(source, options), key);
  EXPECT_NE(checkpoint_key(scene_source(21), TrainOptions{}), key);
}

TEST(Checkpoint, DamageIsNoticed) {
  Training training("damaged");
  training.run(10);
  const std::string bytes = content_of(training.kept());
  ASSERT_GT(bytes.size(), 1000u);
  for (size_t at = 0; at < bytes.size(); at += bytes.size() / 40 + 1) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    ASSERT_TRUE(replace_file(training.kept(), as_bytes(damaged)).ok());
    EXPECT_EQ(read_checkpoint(training.kept(), training.key()).status().code(),
              StatusCode::kDataLoss);
    ASSERT_TRUE(replace_file(training.kept(), as_bytes(bytes.substr(0, at))).ok());
    EXPECT_EQ(read_checkpoint(training.kept(), training.key()).status().code(),
              StatusCode::kDataLoss);
  }
  EXPECT_TRUE(training.run() == Training("undamaged").run());
}

TEST(Checkpoint, WhatIsNotOfSuchAFitIsIgnored) {
  Training training("hostile");
  training.run(18);
  const auto good = read_checkpoint(training.kept(), training.key());
  ASSERT_TRUE(good.ok()) << good.status().to_string();
  const auto changed = [&](auto change) {
    Checkpoint checkpoint = *good;
    change(checkpoint);
    return checkpoint;
  };
  const auto tensor = [](idf::Data& data) -> idf::Data& { return *data.at("weights/0"); };
  const std::vector<Checkpoint> hostile{
      changed([](Checkpoint& c) { c.state = idf::Dict{}; }),
      changed([](Checkpoint& c) { c.state.at("weights")->value() = idf::List{}; }),
      changed([](Checkpoint& c) { c.state.at("moments")->value() = idf::List{}; }),
      changed([](Checkpoint& c) { c.state.at("step")->value() = int64_t{-1}; }),
      changed([](Checkpoint& c) { c.state.at("generator")->value() = idf::NdArray(); }),
      changed([](Checkpoint& c) { c.state.at("numbers")->value() = std::string("none"); }),
      changed([&](Checkpoint& c) {
        tensor(c.state) = idf::NdArray::take<float>({1}, std::vector<float>{1});
      }),
      changed([&](Checkpoint& c) {
        const auto& array = tensor(c.state).get<idf::NdArray>();
        std::vector<float> values(static_cast<size_t>(array.count()),
                                  std::numeric_limits<float>::quiet_NaN());
        tensor(c.state) = idf::NdArray::take<float>(array.shape(), std::move(values));
      })};
  const std::string whole = Training("whole_again").run();
  for (size_t i = 0; i < hostile.size(); ++i) {
    ASSERT_TRUE(write_checkpoint(training.kept(), training.key(), hostile[i]).ok());
    EXPECT_TRUE(training.run() == whole) << i;
  }
  for (const double share : {-0.5, std::numeric_limits<double>::quiet_NaN()}) {
    const auto bad = changed([&](Checkpoint& c) { c.share = share; });
    ASSERT_TRUE(write_checkpoint(training.kept(), training.key(), bad).ok());
    EXPECT_EQ(read_checkpoint(training.kept(), training.key()).status().code(),
              StatusCode::kDataLoss);
  }
}

TEST(Checkpoint, GoesOnWithTheShareOfTheTimeThatWasReached) {
  Training training("share");
  training.options.steps.reset();
  training.options.budget = std::chrono::hours(1);
  training.run(2);
  EXPECT_LT(training.first_done, 10u);  // Of 1000.
  auto kept = read_checkpoint(training.kept(), training.key());
  ASSERT_TRUE(kept.ok()) << kept.status().to_string();
  kept->share = 0.6;
  ASSERT_TRUE(write_checkpoint(training.kept(), training.key(), *kept).ok());
  training.run(2);
  EXPECT_NEAR(static_cast<double>(training.first_done), 0.6 * 720, 10);
}

}  // namespace
}  // namespace engram::training
