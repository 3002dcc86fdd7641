// SPDX-License-Identifier: Apache-2.0
#include "training/fit/stage_times.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

namespace engram::training {
namespace {

TEST(StageTimes, CountsEveryMomentForTheInnermostStage) {
  StageTime now{100, 1000};
  const auto work = [&now](double processor_seconds) {
    now.processor_seconds += processor_seconds;
    now.seconds += 2 * processor_seconds;
  };
  StageTimes times([&now] { return now; });
  work(64);  // Outside all scopes.
  {
    const StageTimes::Scope other(&times, Stage::kOther);
    work(1);
    {
      const StageTimes::Scope latents(&times, Stage::kLatents);
      work(2);
      const StageTimes::Scope video(&times, Stage::kVideo);
      work(4);
    }
    work(8);
    const StageTimes::Scope again(&times, Stage::kVideo);
    work(16);
  }
  work(64);
  EXPECT_EQ(times.of(Stage::kOther).processor_seconds, 9);
  EXPECT_EQ(times.of(Stage::kLatents).processor_seconds, 2);
  EXPECT_EQ(times.of(Stage::kVideo).processor_seconds, 20);
  EXPECT_EQ(times.of(Stage::kPlan).processor_seconds, 0);
  EXPECT_EQ(times.total().processor_seconds, 31);
  EXPECT_EQ(times.total().seconds, 62);
}

TEST(StageTimes, MeasuresNothingWithoutAPlaceForIt) {
  const StageTimes::Scope scope(nullptr, Stage::kVideo);
}

TEST(StageTimes, ReadsProcessorTimeOfThreadsThatHaveEnded) {
  StageTimes times;
  {
    const StageTimes::Scope scope(&times, Stage::kTraining);
    const auto works = [] {
      double sum = 0;
      const double start = process_clocks().processor_seconds;
      while (process_clocks().processor_seconds < start + 0.05) sum += std::sqrt(sum + 1);
      EXPECT_GT(sum, 0);
    };
    std::jthread(works).join();
  }
  EXPECT_GE(times.of(Stage::kTraining).processor_seconds, 0.05);
  EXPECT_GT(times.of(Stage::kTraining).seconds, 0);
}

TEST(StageTimes, HasANameForEveryStage) {
  EXPECT_EQ(to_string(Stage::kPlan), "plan");
  EXPECT_EQ(to_string(Stage::kOther), "other");
}

}  // namespace
}  // namespace engram::training
