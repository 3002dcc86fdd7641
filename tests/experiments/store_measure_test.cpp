// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <thread>

#include "ltm/recording/recorder.h"
#include "store/fresh_process.h"
#include "store/scale_writer.h"
#include "store/store_measure.h"
#include "store/stream.h"
#include "store/thread_run.h"
#include "store/verify_store.h"

namespace engram::experiments {
namespace {

StreamSource two_frames(uint8_t shade) {
  StreamSource source;
  for (uint8_t frame = 0; frame < 2; ++frame) {
    std::vector<uint8_t> pixels(size_t{640} * 480 * 3, static_cast<uint8_t>(shade + frame));
    source.frames.push_back(idf::NdArray::take<uint8_t>({480, 640, 3}, std::move(pixels)));
    source.joints.push_back({0.1 * frame});
  }
  return source;
}

std::filesystem::path scratch(const char* name) {
  return std::filesystem::path(testing::TempDir()) / "engram_store_measure" / name;
}

Status record(const Stream& stream, const std::filesystem::path& store) {
  ENGRAM_RETURN_IF_ERROR(make_empty(store));
  ENGRAM_ASSIGN_OR_RETURN(auto recorder, ltm::Recorder::open(store, {}));
  for (size_t i = 0; i < stream.ticks(); ++i)
    ENGRAM_RETURN_IF_ERROR(recorder.commit(commit_of(stream.tick(i))));
  return recorder.close();
}

TEST(Measure, QuantileIsTheSmallestValueThatSoManyDoNotExceed) {
  const std::vector<double> values{4, 1, 3, 2};
  EXPECT_EQ(quantile(values, 0.5), 2);
  EXPECT_EQ(quantile(values, 0.51), 3);
  EXPECT_EQ(quantile(values, 0.99), 4);
  EXPECT_EQ(quantile(values, 0), 1);
}

TEST(Measure, FindsFilesBelowAFolderInOrderAndTellsWhereItCannot) {
  const auto folder = scratch("files");
  ASSERT_TRUE(make_empty(folder / "b.csv").ok());
  for (const char* name : {"z.csv", "b.csv/a.csv", "b.csv/a.mp4"})
    std::ofstream(folder / name) << 1;
  EXPECT_EQ(files_below(folder, ".csv").value(),
            (std::vector{folder / "b.csv/a.csv", folder / "z.csv"}));
  EXPECT_EQ(files_below(folder / "none", ".csv").status().code(), StatusCode::kNotFound);
  EXPECT_EQ(files_below(folder / "z.csv", ".csv").status().code(), StatusCode::kUnavailable);
}

TEST(RunThreads, CountsFromTheFirstBeginToTheLastEnd) {
  using Clock = std::chrono::steady_clock;
  std::array<Clock::time_point, 2> begin, end;
  const auto work = [&](size_t thread) {
    return [&, thread] {
      begin[thread] = Clock::now();
      std::this_thread::sleep_for(std::chrono::milliseconds(1 + 3 * thread));
      end[thread] = Clock::now();
      return Status();
    };
  };
  const Works works{work(0), work(1)};
  for (int run = 0; run < 20; ++run) {
    const Pass pass = run_threads(works, 2).value();
    const auto spanned = std::max(end[0], end[1]) - std::min(begin[0], begin[1]);
    EXPECT_GE(pass.seconds, std::chrono::duration<double>(spanned).count());
    EXPECT_GE(pass.spent.waits, 2);
  }
  EXPECT_GE(run_threads(works, 1)->seconds, 0.001);
}

TEST(RunThreads, TellsWhatFailed) {
  const Works works{[] { return Status(); }, [] { return data_loss("torn"); }};
  EXPECT_TRUE(run_threads(works, 1).ok());
  EXPECT_EQ(run_threads(works, 2).status().code(), StatusCode::kDataLoss);
}

TEST(FreshProcess, HandsOverWhatWasFoundAndWhatFailed) {
  EXPECT_EQ(in_fresh_process([] { return Result<nlohmann::json>(7); }).value(), 7);
  const auto failed =
      in_fresh_process([]() -> Result<nlohmann::json> { return not_found("no {}", "cup"); });
  EXPECT_EQ(failed.status().message(), "not found: no cup");
  const auto died = in_fresh_process([]() -> Result<nlohmann::json> { ::_exit(3); });
  EXPECT_EQ(died.status().code(), StatusCode::kUnavailable);
}

TEST(Stream, HasTheRateOfThePaper) {
  const Stream stream(two_frames(0), 2);
  // Two images of 921,600 bytes 20 times a second, 86 doubles 100 times, and a little more.
  EXPECT_GT(stream.raw_bytes() / 2, 36'864'000u + 68'800u);
  EXPECT_LT(stream.raw_bytes() / 2, 36'864'000u + 68'800u + 5'000u);
  EXPECT_EQ(stream.tick_at(stream.tick(137).time), 137u);
}

TEST(Stream, ShowsEachCameraAnotherFrame) {
  const Stream stream(two_frames(0), 1);
  const Tick tick = stream.tick(5);
  ASSERT_EQ(tick.images.size(), 2u);
  EXPECT_NE(tick.images[0], tick.images[1]);
  EXPECT_TRUE(commit_of(tick).check().ok());
}

TEST(VerifyStore, TakesOnlyWhatTheStreamSaid) {
  const Stream stream(two_frames(0), 0.2), other(two_frames(9), 0.2);
  const auto store = scratch("verify");
  ASSERT_TRUE(record(stream, store).ok());
  EXPECT_TRUE(verify_store(store, stream, count_snapshots(stream)).ok());
  EXPECT_EQ(verify_store(store, stream, count_snapshots(stream) + 1).code(), StatusCode::kDataLoss);
  EXPECT_EQ(verify_store(store, other, count_snapshots(other)).code(), StatusCode::kDataLoss);
}

TEST(ScaleWorld, GivesEverySnapshotAValueOfItsOwn) {
  const idf::Data value = ScaleWorld::value(3, 7);
  EXPECT_EQ(value, ScaleWorld::value(3, 7));
  EXPECT_NE(value, ScaleWorld::value(4, 7));
  EXPECT_NE(value, ScaleWorld::value(3, 8));
}

}  // namespace
}  // namespace engram::experiments
