// SPDX-License-Identifier: Apache-2.0
// The offline phase as a nightly job: interrupted, hurried, and beside a robot that is busy.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "ltm/core/file.h"
#include "ltm/store/store_reader.h"
#include "tests/training/recorded_scene.h"
#include "training/fit/job_pace.h"
#include "training/night/consolidate.h"
#include "training/night/drop_raw.h"
#include "training/quality/psnr.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::quick_consolidation;
using engram::testing::quick_options;
using engram::testing::record;
using engram::testing::scene_source;
using engram::testing::ScratchPath;

std::vector<std::filesystem::path> files_in(const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(directory))
    files.push_back(entry.path());
  return files;
}

std::string content_of(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  return bytes.ok() ? std::string(as_text(bytes->bytes())) : std::string();
}

std::string model_of(const std::filesystem::path& store) {
  return content_of(store / ltm::read_manifest(store)->models.front().file);
}

/// Runs until progress on `what` is told, then stops.
void interrupt(const std::filesystem::path& store, const ConsolidateOptions& options,
               const std::string& what) {
  std::stop_source stop;
  const ProgressSink sink = [&](const Progress& progress) {
    if (progress.what.starts_with(what) && progress.done >= 10) stop.request_stop();
  };
  EXPECT_EQ(consolidate(store, options, sink, stop.get_token()).status().code(),
            StatusCode::kCancelled);
}

TEST(NightlyJob, GoesOnWhereItWasInterrupted) {
  const ScratchPath whole("whole_night"), broken("broken_night");
  for (const auto* store : {&whole, &broken}) record(store->path(), "Test/Scene/sim/square", 0, 20);
  ConsolidateOptions options = quick_consolidation();
  options.access = Duration::zero();
  options.train.chain_rows = 8;
  ASSERT_TRUE(consolidate(whole.path(), options, {}, {}).ok());
  EXPECT_TRUE(files_in(whole.path() / "tmp").empty());
  for (const char* what : {"train", "encode"}) {
    interrupt(broken.path(), options, what);
    EXPECT_EQ(files_in(broken.path() / "tmp").size(), 1u) << what;
  }
  int trained = 0;
  const ProgressSink sink = [&](const Progress& progress) {
    trained += progress.what.starts_with("train") ? 1 : 0;
  };
  const auto report = consolidate(broken.path(), options, sink, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(trained, 0) << "was done already";
  EXPECT_EQ(report->entities[0].training.autoencoder_steps, 14);
  EXPECT_TRUE(model_of(broken.path()) == model_of(whole.path()));
  EXPECT_TRUE(files_in(broken.path() / "tmp").empty());
}

TEST(NightlyJob, RemovesWhatNothingGoesOnFrom) {
  const ScratchPath store("stale_night");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  const auto kept = [&] { return files_in(store.path() / "tmp"); };
  auto other = quick_consolidation();
  other.access = Duration::zero();  // What was measured of chains would be kept, too.
  interrupt(store.path(), other, "train");
  const auto first = kept();
  ASSERT_EQ(first.size(), 1u);
  other.train.seed = 5;
  interrupt(store.path(), other, "train");
  ASSERT_EQ(kept().size(), 1u);
  EXPECT_NE(kept(), first);
  record(store.path(), "Test/Scene/sim/square", 20, 2);
  interrupt(store.path(), other, "train");
  EXPECT_EQ(kept().size(), 1u) << "of the data that is there now";
  other.job.is_fresh = true;
  const auto report = consolidate(store.path(), other, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  for (const std::string& note : report->entities[0].training.notes)
    EXPECT_EQ(note.find("went on"), std::string::npos) << note;
  EXPECT_TRUE(kept().empty());
}

/// Consolidates until a moment that leaves time to train: on a machine that is busy, a later one.
EntityReport in_time(const std::filesystem::path& store, ConsolidateOptions& options) {
  for (std::chrono::seconds time(8);; time *= 3) {
    options.job.until = system_now() + time;
    const auto report = consolidate(store, options, {}, {});
    EXPECT_TRUE(report.ok()) << report.status().to_string();
    if (!report.ok()) return {};
    const EntityReport& entity = report->entities[0];
    const bool is_too_short = entity.skipped_reason.empty()
                                  ? entity.training.autoencoder_steps == 0
                                  : entity.skipped_reason.starts_with("the time was over");
    if (!is_too_short || time.count() > 600) return entity;
  }
}

TEST(NightlyJob, IsDoneAtTheMomentThatWasAskedFor) {
  const ScratchPath store("until");
  record(store.path(), "Test/Scene/sim/square", 0, 40);
  auto chosen = quick_consolidation();
  chosen.train.steps.reset();
  const EntityReport entity = in_time(store.path(), chosen);
  EXPECT_EQ(entity.skipped_reason, "");
  EXPECT_GT(entity.expected_encoding_seconds, 0);
  EXPECT_GT(entity.encoding_seconds, 0);
  EXPECT_GT(entity.training.autoencoder_steps, 0);
  EXPECT_LT(system_now(), *chosen.job.until + std::chrono::minutes(2));

  chosen.force = true;
  chosen.job.until = system_now() - std::chrono::seconds(1);
  const auto late = consolidate(store.path(), chosen, {}, {});
  ASSERT_TRUE(late.ok()) << late.status().to_string();
  EXPECT_EQ(late->entities[0].skipped_reason, "the time was over before anything was encoded");
  chosen.train.steps = 3;
  EXPECT_EQ(consolidate(store.path(), chosen, {}, {}).status().code(),
            StatusCode::kInvalidArgument);
}

TEST(NightlyJob, WaitsWhileTheRobotIsBusy) {
  const ScratchPath store("busy_night"), idle("idle_night"), file("busy_night_file");
  for (const auto* each : {&store, &idle}) record(each->path(), "Test/Scene/sim/square", 0, 20);
  auto chosen = quick_consolidation();
  chosen.job.yield.file = file.path();
  chosen.job.yield.file_interval = Duration(0);
  int waits = 0;
  bool was_busy = false;
  const ProgressSink sink = [&](const Progress& progress) {
    if (progress.detail.starts_with("waiting: ")) {
      EXPECT_FALSE(files_in(store.path() / "tmp").empty());
      if (++waits == 3) std::filesystem::remove(file.path());
    } else if (progress.done >= 5 && !std::exchange(was_busy, true)) {
      EXPECT_TRUE(replace_file(file.path(), {}).ok());
    }
  };
  const auto report = consolidate(store.path(), chosen, sink, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(waits, 3);
  ASSERT_TRUE(consolidate(idle.path(), quick_consolidation(), {}, {}).ok());
  EXPECT_TRUE(model_of(store.path()) == model_of(idle.path()));
}

TEST(NightlyJob, GivesUpWhereTheRobotIsBusyAllNight) {
  const ScratchPath store("all_night"), file("all_night_file");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  auto chosen = quick_consolidation();
  chosen.train.steps.reset();
  chosen.job.yield.file = file.path();
  ASSERT_TRUE(replace_file(file.path(), {}).ok());
  const EntityReport entity = in_time(store.path(), chosen);
  std::filesystem::remove(file.path());
  EXPECT_TRUE(entity.skipped_reason.starts_with("the robot was busy until"))
      << entity.skipped_reason;
  EXPECT_EQ(files_in(store.path() / "tmp").size(), 2u) << "what was kept stays, and what is known";
}

TEST(DropRaw, WaitsWhileTheRobotIsBusyAndDropsNothingWhereItIsUntilTheEnd) {
  const ScratchPath store("busy_drop"), file("busy_drop_file");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  ASSERT_TRUE(consolidate(store.path(), quick_consolidation(), {}, {}).ok());
  const auto entity = id("Test/Scene/sim/square");
  RobotBusy::Options yield;
  yield.file = file.path();
  yield.file_interval = Duration(0);
  const auto busy = RobotBusy::create(yield);
  ASSERT_TRUE(busy.ok()) << busy.status().to_string();
  ASSERT_TRUE(replace_file(file.path(), {}).ok());
  const std::stop_token stop;
  const ProgressSink no_progress;
  JobPace late(busy->get(), no_progress, stop, system_now());
  EXPECT_EQ(drop_raw(store.path(), entity, {}, {}, stop, &late).status().code(),
            StatusCode::kResourceExhausted);
  EXPECT_TRUE(late.is_time_over());
  int waits = 0;
  const ProgressSink sink = [&](const Progress& progress) {
    if (progress.detail.starts_with("waiting: ") && ++waits == 2)
      std::filesystem::remove(file.path());
  };
  JobPace pace(busy->get(), sink, stop);
  const auto dropped = drop_raw(store.path(), entity, {}, sink, stop, &pace);
  ASSERT_TRUE(dropped.ok()) << dropped.status().to_string();
  EXPECT_EQ(waits, 2);
  EXPECT_EQ(dropped->snapshots, 20u) << "none had gone before";
}

TEST(DropRaw, LeavesYoungDataRecorded) {
  const ScratchPath store("grace");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  ASSERT_TRUE(consolidate(store.path(), quick_consolidation(), {}, {}).ok());
  const auto entity = id("Test/Scene/sim/square");
  const DropOptions young{.stays_from = scene_source(20).times[12]};
  const auto dropped = drop_raw(store.path(), entity, young, {}, {});
  ASSERT_TRUE(dropped.ok()) << dropped.status().to_string();
  EXPECT_EQ(dropped->snapshots, 12u);
  EXPECT_EQ(dropped->kept, 8u);
  const auto reader = *ltm::StoreReader::open(store.path());
  const auto& entries = **reader->index(entity);
  for (size_t i = 0; i < entries.size(); ++i) {
    EXPECT_EQ(entries[i].recorded.has_value(), i >= 12) << i;
    EXPECT_TRUE(entries[i].latent.has_value()) << i;
  }
}

/// The measured errors of an entity's latents, in the order of time.
std::vector<ltm::MeasuredError> errors_of(ltm::StoreReader& reader, const ltm::MemoryId& entity) {
  std::vector<ltm::MeasuredError> errors;
  for (const ltm::SnapshotEntry& entry : **reader.index(entity))
    errors.push_back(reader.read_latent(entity, entry)->instances.front().quality.error);
  return errors;
}

TEST(DropRaw, LeavesRecordedWhatItsLatentsMissTheBoundOf) {
  const ScratchPath store("bounds");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  ASSERT_TRUE(consolidate(store.path(), quick_consolidation(), {}, {}).ok());
  const auto entity = id("Test/Scene/sim/square");
  const auto errors = errors_of(**ltm::StoreReader::open(store.path()), entity);
  std::vector<double> psnr;
  for (const auto& error : errors) psnr.push_back(psnr_db(error.image_mse));
  std::vector<double> sorted = psnr;
  std::ranges::sort(sorted);
  ASSERT_LT(sorted[6], sorted[7]);
  const double between = (sorted[6] + sorted[7]) / 2;

  const DropOptions of_numbers{.max_rmse = 1e-12};
  const auto none = drop_raw(store.path(), entity, of_numbers, {}, {});
  ASSERT_TRUE(none.ok()) << none.status().to_string();
  EXPECT_EQ(none->snapshots, 0u) << "numbers are within a bound, not equal";

  const DropOptions of_images{.min_psnr_db = between};
  const auto dropped = drop_raw(store.path(), entity, of_images, {}, {});
  ASSERT_TRUE(dropped.ok()) << dropped.status().to_string();
  EXPECT_EQ(dropped->snapshots, 13u);
  EXPECT_EQ(dropped->kept, 7u);
  const auto reader = *ltm::StoreReader::open(store.path());
  const auto& entries = **reader->index(entity);
  for (size_t i = 0; i < entries.size(); ++i)
    EXPECT_EQ(entries[i].recorded.has_value(), psnr[i] < between) << i << ": " << psnr[i] << " dB";
}

}  // namespace
}  // namespace engram::training
