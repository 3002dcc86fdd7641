// SPDX-License-Identifier: Apache-2.0
#include "datasets/video_table.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "datasets/recordings/import_recording.h"
#include "ltm/store/store_reader.h"
#include "tests/datasets/fixtures.h"

namespace engram::datasets {
namespace {

using ltm::MemoryId;
using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::TemporaryDirectory;

const Time kStart = *parse_time("2022-02-18 13:06:56");
const Time kNow = *parse_time("2024-01-01 00:00:00");

/// A video at 10 Hz beside a store, and what imports it.
class ImportedVideoTable : public ::testing::Test {
 protected:
  ImportedVideoTable() {
    const Status status = testing::write_video(directory_ / "a.mp4", 10,
                                               {.width = 64, .height = 48, .rate_numerator = 10});
    EXPECT_TRUE(status.ok()) << status.to_string();
    options_.video = directory_ / "a.mp4";
    options_.entity = *MemoryId::parse("Vision/RGB/head/camera");
    options_.state_entity = *MemoryId::parse("Body/State/arm/joints");
    options_.start = kStart;
    options_.clock = [] { return kNow; };
  }

  void write_table(std::string_view content) {
    options_.table = directory_.write("a.csv", content);
  }

  Result<ltm::Recorder> open() { return ltm::Recorder::open(directory_ / "store", {}); }

  Result<RecordingImportReport> run(std::stop_token stop = {}) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Recorder recorder, open());
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, VideoTable::open(options_));
    auto report = import_recording(*reader, "video", recorder, progress_, stop);
    ENGRAM_RETURN_IF_ERROR(recorder.close());
    return report;
  }

  /// What the store holds of an entity, in the order of time.
  std::vector<ltm::Snapshot> stored(const MemoryId& entity) {
    auto reader = ltm::StoreReader::open(directory_ / "store");
    EXPECT_TRUE(reader.ok()) << reader.status().to_string();
    std::vector<ltm::Snapshot> snapshots;
    const auto index = (*reader)->index(entity);
    if (!index.ok()) return snapshots;
    for (const ltm::SnapshotEntry& entry : **index) {
      auto snapshot = (*reader)->read_recorded(entity, entry);
      EXPECT_TRUE(snapshot.ok()) << snapshot.status().to_string();
      snapshots.push_back(std::move(snapshot).value());
    }
    return snapshots;
  }

  static const idf::Data& value(const ltm::Snapshot& snapshot) {
    return snapshot.instances.at(0).data;
  }
  static std::string link(const ltm::Snapshot& snapshot, std::string_view key) {
    const idf::Data* found = value(snapshot).at(key);
    return found == nullptr ? "" : found->get<std::string>();
  }

  TemporaryDirectory directory_;
  VideoTable::Options options_;
  ProgressSink progress_;
};

TEST_F(ImportedVideoTable, ImportsAVideoAloneWithoutLinks) {
  options_.provider = "head";
  const auto report = run();
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->counts.at("frames"), 10u);
  EXPECT_EQ(report->values, 10u);
  EXPECT_FALSE(report->counts.contains("rows"));
  EXPECT_EQ(report->reading.damaged, 0u);
  EXPECT_EQ(report->reading.duplicate_images, 0u);
  EXPECT_EQ(report->first, kStart);
  EXPECT_EQ(report->last, kStart + milliseconds(900));
  EXPECT_FALSE(report->is_cancelled);

  const auto images = stored(options_.entity);
  ASSERT_EQ(images.size(), 10u);
  auto reader = VideoReader::open(options_.video, {});
  const auto [frames, end] = testing::read_all(*reader);
  for (size_t i = 0; i < images.size(); ++i) {
    EXPECT_EQ(images[i].time, kStart + i * milliseconds(100));
    ASSERT_EQ(images[i].instances.size(), 1u);
    EXPECT_TRUE(value(images[i]) == idf::Data(idf::Dict{{"image", frames[i].image}})) << i;
    const ltm::InstanceMetadata expected{
        .created = images[i].time, .sent = kNow, .arrived = kNow, .provider = "head"};
    EXPECT_EQ(images[i].instances[0].metadata, expected);
  }
}

TEST_F(ImportedVideoTable, LinksEqualTimesExactly) {
  std::string content = "timestamp,joint.elbow,n\n";
  for (int i = 0; i < 10; ++i) content += fmt::format("0.{},{},{}\n", i, 0.5 * i, i);
  write_table(content);
  const auto report = run();
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->counts.at("frames"), 10u);
  EXPECT_EQ(report->counts.at("rows"), 10u);
  EXPECT_EQ(report->reading.rows_outside, 0u);
  const auto images = stored(options_.entity), rows = stored(options_.state_entity);
  ASSERT_EQ(images.size(), 10u);
  ASSERT_EQ(rows.size(), 10u);
  for (size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(link(images[i], "state"), rows[i].id().to_string());
    EXPECT_EQ(link(rows[i], "camera"), images[i].id().to_string());
  }
  const idf::Data expected = idf::Dict{
      {"joint", idf::Dict{{"elbow", 1.5}}}, {"n", 3.0}, {"camera", images[3].id().to_string()}};
  EXPECT_EQ(value(rows[3]), expected);
}

TEST_F(ImportedVideoTable, LinksTheNearestAndTheEarlierOfTwoAsNear) {
  write_table("t,a\n-0.3,0\n0.04,1\n0.06,2\n0.15,3\n0.81,4\n2,5\n");
  const auto report = run();
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->counts.at("rows"), 6u);
  EXPECT_EQ(report->reading.rows_outside, 2u);
  EXPECT_EQ(report->first, kStart - milliseconds(300));
  EXPECT_EQ(report->last, kStart + seconds(2));
  const auto images = stored(options_.entity), rows = stored(options_.state_entity);
  ASSERT_EQ(rows.size(), 6u);
  const std::vector<size_t> image_of_row{0, 0, 1, 1, 8, 9};
  for (size_t i = 0; i < rows.size(); ++i)
    EXPECT_EQ(link(rows[i], "camera"), images[image_of_row[i]].id().to_string()) << i;
  const std::vector<size_t> row_of_image{1, 2, 3, 3, 3, 4, 4, 4, 4, 4};
  for (size_t i = 0; i < images.size(); ++i)
    EXPECT_EQ(link(images[i], "state"), rows[row_of_image[i]].id().to_string()) << i;
}

TEST_F(ImportedVideoTable, MovesTheTableByItsOffset) {
  write_table("t,a\n1000.0,0\n1000.1,1\n");
  options_.table_offset = -seconds(1000);
  ASSERT_TRUE(run().ok());
  const auto rows = stored(options_.state_entity);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].time, kStart + milliseconds(100));
}

TEST_F(ImportedVideoTable, ScalesAndCrops) {
  options_.width = options_.height = 16;
  options_.crops_square = true;
  ASSERT_TRUE(run().ok());
  EXPECT_EQ(value(stored(options_.entity)[0]).at("image")->get<idf::NdArray>().shape(),
            (idf::Shape{16, 16, 3}));
}

TEST_F(ImportedVideoTable, CountsAndKeepsWhatTheRateLeaves) {
  options_.width = 16;
  auto recorder = *ltm::Recorder::open(directory_ / "store", {.max_rate_hz = 5});
  const auto table = *VideoTable::open(options_);
  const auto report = *import_recording(*table, "video", recorder, progress_, {});
  EXPECT_EQ(report.counts.at("frames"), 10u);
  EXPECT_EQ(report.last, kStart + milliseconds(900));
  const ltm::RecordingCounters counters = recorder.counters().at(options_.entity);
  EXPECT_EQ(counters.offered, 10u);
  EXPECT_EQ(counters.offered_bytes, 2 * counters.kept_bytes);
  EXPECT_EQ(counters.dropped_by.at("frequency"), 5u);
  ASSERT_TRUE(recorder.close().ok());

  auto reader = *VideoReader::open(options_.video, {.width = 16});
  const auto [frames, status] = testing::read_all(reader);
  const auto kept = stored(options_.entity);
  ASSERT_EQ(kept.size(), 5u);
  for (size_t i = 0; i < kept.size(); ++i) {
    EXPECT_EQ(kept[i].time, kStart + frames[2 * i].time);
    EXPECT_EQ(value(kept[i]).at("image")->get<idf::NdArray>(), frames[2 * i].image);
  }
}

TEST_F(ImportedVideoTable, CountsFramesThatRepeatTheOneBefore) {
  auto writer = VideoWriter::create(directory_ / "b.mp4",
                                    {.width = 64, .height = 48, .crf = 0, .keeps_chroma = true});
  ASSERT_TRUE(writer.ok());
  for (const int step : {0, 0, 5, 5, 5, 0}) {
    ASSERT_TRUE(writer->write(testing::smooth_image(64, 48, step)).ok());
  }
  ASSERT_TRUE(writer->close().ok());
  options_.video = directory_ / "b.mp4";
  const auto report = run();
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->counts.at("frames"), 6u);
  EXPECT_EQ(report->reading.duplicate_images, 3u);
}

TEST_F(ImportedVideoTable, RefusesAStartThatIsTakenAndNamesOneThatFits) {
  ASSERT_TRUE(run().ok());
  options_.start = kStart + milliseconds(500);
  const auto second = run();
  ASSERT_EQ(second.status().code(), StatusCode::kFailedPrecondition);
  for (const Time time : {kStart + milliseconds(900), kStart + seconds(1)})
    EXPECT_NE(second.status().message().find(to_string(time)), std::string::npos)
        << second.status().message();
  EXPECT_EQ(stored(options_.entity).size(), 10u);
  options_.start = kStart + seconds(1);
  EXPECT_TRUE(run().ok());
  EXPECT_EQ(stored(options_.entity).size(), 20u);
}

TEST_F(ImportedVideoTable, RefusesAStartThatIsTakenByTheTable) {
  write_table("t,a\n0,1\n5,2\n");
  ASSERT_TRUE(run().ok());
  options_.start = kStart + seconds(2);
  const auto second = run();
  ASSERT_EQ(second.status().code(), StatusCode::kFailedPrecondition);
  EXPECT_NE(second.status().message().find("Body/State/arm/joints"), std::string::npos);
  EXPECT_EQ(stored(options_.entity).size(), 10u) << "nothing was committed";
}

TEST_F(ImportedVideoTable, CommitsNothingWhereTheTableIsTakenLater) {
  write_table("t,a\n0,1\n5,2\n");
  ASSERT_TRUE(run().ok());
  write_table("t,a\n0.85,1\n");
  options_.start = kStart + seconds(4);
  EXPECT_EQ(run().status().code(), StatusCode::kFailedPrecondition);
  EXPECT_EQ(stored(options_.entity).size(), 10u) << "nothing was committed";
}

TEST_F(ImportedVideoTable, NamesAStartThatFitsWhereTheTableBeginsBeforeTheVideo) {
  write_table("t,a\n-2.5,1\n1,2\n");
  ASSERT_TRUE(run().ok());
  options_.start = kStart + seconds(2);
  const auto second = run();
  ASSERT_EQ(second.status().code(), StatusCode::kFailedPrecondition);
  const Time fits = kStart + seconds(4);
  EXPECT_NE(second.status().message().find("a start of " + to_string(fits)), std::string::npos)
      << second.status().message();
  options_.start = fits;
  EXPECT_TRUE(run().ok());
}

TEST_F(ImportedVideoTable, ListsItsStreamsBeforeAnythingIsStored) {
  write_table("t,a\n0,1\n0.1,2\n");
  const auto reader = *VideoTable::open(options_);
  ASSERT_EQ(reader->streams().size(), 2u);
  EXPECT_EQ(reader->streams()[0].name, "a.mp4");
  EXPECT_EQ(reader->streams()[0].entity, options_.entity);
  EXPECT_EQ(reader->streams()[0].values, 10u);
  EXPECT_EQ(reader->streams()[1].name, "a.csv");
  EXPECT_EQ(reader->streams()[1].values, 2u);
  EXPECT_EQ(reader->total(), 12u);
}

TEST_F(ImportedVideoTable, LeavesNothingInTheStoreBesideItsValues) {
  write_table("t,a\n0,1\n");
  ASSERT_TRUE(run().ok());
  auto reader = *ltm::StoreReader::open(directory_ / "store");
  EXPECT_EQ(reader->entities().size(), 2u);
}

TEST_F(ImportedVideoTable, HandsOverImagesUnmadeAndMakesThemOnDemand) {
  const auto reader = *VideoTable::open(options_);
  auto moment = *reader->next();
  ASSERT_TRUE(moment && moment->unmade);
  ltm::EntityUpdate& update = moment->commit.updates.at(0);
  const size_t bytes = update.raw_bytes();
  const idf::Data stand_in = update.instances.at(0).data;
  ASSERT_TRUE((*reader->next())->unmade) << "the next one may be read before this one is made";
  ASSERT_TRUE(moment->unmade->make(update).ok());
  EXPECT_EQ(update.raw_bytes(), bytes);
  EXPECT_FALSE(update.instances.at(0).data == stand_in);
  auto video = *VideoReader::open(options_.video, {});
  EXPECT_EQ(update.instances.at(0).data.at("image")->get<idf::NdArray>(), (*video.next())->image);
}

TEST_F(ImportedVideoTable, StopsBetweenCommitsAndKeepsWhatItCommitted) {
  std::string content = "t,a\n";
  for (int i = 0; i < 20; ++i) content += fmt::format("{},{}\n", 0.05 * i, i);
  write_table(content);
  std::stop_source stop;
  progress_ = [&stop](const Progress&) { stop.request_stop(); };
  const auto report = run(stop.get_token());
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_TRUE(report->is_cancelled);
  EXPECT_EQ(report->counts.at("frames") + report->counts.at("rows"), 16u);
  EXPECT_EQ(stored(options_.entity).size(), report->counts.at("frames"));
  EXPECT_EQ(stored(options_.state_entity).size(), report->counts.at("rows"));
}

TEST_F(ImportedVideoTable, TellsItsProgressToTheEnd) {
  write_table("t,a\n0,1\n0.1,2\n");
  Progress last;
  progress_ = [&last](const Progress& progress) {
    EXPECT_LE(progress.done, progress.total);
    last = progress;
  };
  ASSERT_TRUE(run().ok());
  EXPECT_EQ(last.what, "import video");
  EXPECT_EQ(last.done, 12u);
  EXPECT_EQ(last.total, 12u);
}

TEST_F(ImportedVideoTable, SaysHowMuchItCommittedBeforeTheVideoBroke) {
  ASSERT_TRUE(testing::write_video(directory_ / "b.mp4", 60, {.width = 64, .height = 48}).ok());
  const std::string bytes = testing::content_of(directory_ / "b.mp4");
  options_.video = directory_.write("torn.mp4", bytes.substr(0, bytes.size() * 7 / 10));
  const auto report = run();
  ASSERT_EQ(report.status().code(), StatusCode::kDataLoss) << report.status().to_string();
  const auto images = stored(options_.entity);
  EXPECT_GT(images.size(), 10u);
  EXPECT_NE(report.status().message().find(fmt::format("after {} frames", images.size())),
            std::string::npos)
      << report.status().message();
}

TEST_F(ImportedVideoTable, CommitsNothingWhereAnInputIsBroken) {
  write_table("t,a\n0,1\n0.1,x\n");
  EXPECT_EQ(run().status().code(), StatusCode::kInvalidArgument);
  write_table("t,camera\n0,1\n");
  EXPECT_EQ(run().status().code(), StatusCode::kInvalidArgument);
  write_table("t,camera.x\n0,1\n");
  EXPECT_EQ(run().status().code(), StatusCode::kInvalidArgument);
  options_.table = directory_ / "none.csv";
  EXPECT_EQ(run().status().code(), StatusCode::kNotFound);
  options_.table.clear();
  options_.video = directory_ / "none.mp4";
  EXPECT_EQ(run().status().code(), StatusCode::kNotFound);
  EXPECT_TRUE(stored(options_.entity).empty());
}

TEST_F(ImportedVideoTable, RejectsOptionsThatCannotBe) {
  const VideoTable::Options good = options_;
  options_.entity = *MemoryId::parse("Vision/RGB");
  EXPECT_EQ(run().status().code(), StatusCode::kInvalidArgument);
  options_ = good;
  write_table("t,a\n0,1\n");
  options_.state_entity = MemoryId();
  EXPECT_EQ(run().status().code(), StatusCode::kInvalidArgument);
  options_.state_entity = options_.entity;
  EXPECT_EQ(run().status().code(), StatusCode::kInvalidArgument);
  options_ = good;
  options_.clock = nullptr;
  EXPECT_EQ(run().status().code(), StatusCode::kInvalidArgument);
  options_ = good;
  options_.start = Time::max() - milliseconds(1);
  EXPECT_EQ(run().status().code(), StatusCode::kInvalidArgument);
}

TEST_F(ImportedVideoTable, ImportsARealEpisode) {
  const auto data = testing::recordings();
  if (data.empty()) GTEST_SKIP() << "no recordings: set ENGRAM_RECORDINGS";
  options_.video = data / "g1/videos/chunk-000/observation.images.cam_high/episode_000010.mp4";
  options_.table = data / "g1/tables/episode_000010.csv";
  options_.width = options_.height = 32;
  options_.crops_square = true;
  const auto report = run();
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->counts.at("frames"), 290u);
  EXPECT_EQ(report->counts.at("rows"), 290u);
  EXPECT_EQ(report->reading.damaged, 0u);
  const auto images = stored(options_.entity), rows = stored(options_.state_entity);
  ASSERT_EQ(images.size(), 290u);
  ASSERT_EQ(rows.size(), 290u);
  for (size_t i = 0; i < images.size(); ++i) {
    EXPECT_EQ(link(images[i], "state"), rows[i].id().to_string());
    EXPECT_EQ(link(rows[i], "camera"), images[i].id().to_string());
  }
}

}  // namespace
}  // namespace engram::datasets
