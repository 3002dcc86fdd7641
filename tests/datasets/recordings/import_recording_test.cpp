// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/import_recording.h"

#include <gmock/gmock.h>

#include "ltm/recall/recall.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

using ltm::MemoryId;

const MemoryId kJoints = *MemoryId::parse("RobotState/Proprioception/robot/joints");
const MemoryId kWords = *MemoryId::parse("Speech/Commands/robot/text");

Time at(double seconds) {
  return time_from_ns(static_cast<int64_t>(seconds * 1e9));
}

/// Two episodes with numbers, words in the first.
class TwoEpisodes final : public RecordingReader {
 public:
  explicit TwoEpisodes(Time start) : start_(start) { report_.damaged = 3; }

  [[nodiscard]] const std::vector<RecordingStream>& streams() const override { return streams_; }
  [[nodiscard]] uint64_t total() const override { return 21; }

  Result<std::optional<Moment>> next() override {
    if (index_ == 20) return std::optional<Moment>();
    if (index_ == fails_at) return data_loss("'two.file': broken at offset 7");
    const Time time = start_ + std::chrono::milliseconds(100) * index_;
    Moment moment;
    if (index_ % 10 == 0)
      moment.begins =
          RecordingEpisode{"two", "demo_" + std::to_string(index_ / 10), time, {{"task", "wave"}}};
    moment.commit.updates.push_back({kJoints, time, {{idf::Dict{{"x", index_}}, {}}}});
    if (index_ == 0) moment.commit.updates.push_back({kWords, time, {{idf::Data("hello"), {}}}});
    ++index_;
    return std::optional(std::move(moment));
  }

  int fails_at = -1;

 private:
  Time start_;
  int index_ = 0;
  const std::vector<RecordingStream> streams_{{kJoints, "/joints", 20, {{"unit", "rad"}}},
                                              {kWords, "/words", 1, {}}};
};

class ImportRecording : public testing::Test {
 protected:
  Result<RecordingImportReport> import(RecordingReader& reader, std::stop_token stop = {}) {
    auto recorder = ltm::Recorder::open(scratch_ / "store", {});
    EXPECT_OK(recorder);
    auto report = import_recording(reader, "two", *recorder, {}, stop);
    EXPECT_OK(recorder->close());
    return report;
  }

  std::vector<idf::Data> values(const char* query) {
    ltm::Recall recall(*ltm::StoreReader::open(scratch_ / "store"), {});
    const auto answer = recall.query(*ltm::Query::parse(query));
    std::vector<idf::Data> all;
    if (!answer.ok()) return all;
    for (const MemoryId& id : recall.store().entities()) {
      const ltm::EntityResult* entity = answer->find_entity(id);
      if (entity == nullptr) continue;
      for (const ltm::SnapshotResult& snapshot : entity->snapshots)
        for (const ltm::InstanceResult& instance : snapshot.instances) all.push_back(instance.data);
    }
    return all;
  }

  ScratchDirectory scratch_;
};

TEST_F(ImportRecording, KeepsValuesEpisodesAndStreams) {
  TwoEpisodes reader(at(100));
  const auto report = import(reader);
  ASSERT_OK(report);
  EXPECT_EQ(report->episodes, 2u);
  EXPECT_EQ(report->values, 21u);
  EXPECT_EQ(report->first, at(100));
  EXPECT_EQ(report->last, at(101.9));
  EXPECT_EQ(report->reading.damaged, 3u);
  EXPECT_EQ(values("RobotState @ all").size(), 20u);
  const auto episodes = values("Recording/Episodes @ all");
  ASSERT_EQ(episodes.size(), 2u);
  const auto second = RecordingEpisode::from_data(episodes[1]);
  ASSERT_OK(second);
  EXPECT_EQ(*second, (RecordingEpisode{"two", "demo_1", at(101), {{"task", "wave"}}}));
  const auto streams = values("Recording/Streams/two/RobotState.* @ all");
  ASSERT_EQ(streams.size(), 1u);
  const auto joints = RecordingStream::from_data(streams[0]);
  ASSERT_OK(joints);
  EXPECT_EQ(joints->entity, kJoints);
  EXPECT_EQ(joints->name, "/joints");
  EXPECT_EQ(joints->attributes, (idf::Dict{{"unit", "rad"}}));
}

TEST_F(ImportRecording, RefusesWhatIsThereAlreadyAndNamesAStartThatFits) {
  TwoEpisodes first(at(100));
  ASSERT_OK(import(first));
  TwoEpisodes again(at(101));
  EXPECT_FAILS(import(again), StatusCode::kFailedPrecondition, "1970-01-01 00:01:42");
  TwoEpisodes later(at(102));
  EXPECT_OK(import(later));
  EXPECT_EQ(values("RobotState @ all").size(), 40u);
}

TEST_F(ImportRecording, SaysHowFarItCame) {
  TwoEpisodes reader(at(100));
  reader.fails_at = 5;
  EXPECT_FAILS(import(reader), StatusCode::kDataLoss, "6 values, which stay");
  EXPECT_EQ(values("RobotState @ all").size(), 5u);
}

TEST_F(ImportRecording, StopsBetweenMoments) {
  std::stop_source stop;
  stop.request_stop();
  TwoEpisodes reader(at(100));
  const auto report = import(reader, stop.get_token());
  ASSERT_OK(report);
  EXPECT_TRUE(report->is_cancelled);
  EXPECT_EQ(report->values, 0u);
}

TEST(RecordingDescriptions, RefuseWhatIsNone) {
  EXPECT_FAILS(RecordingStream::from_data(idf::Data(3)), StatusCode::kInvalidArgument, "'entity'");
  const idf::Dict no_entity{{"entity", "A/B"}, {"name", "x"}, {"attributes", idf::Dict()}};
  EXPECT_FAILS(RecordingStream::from_data(no_entity), StatusCode::kInvalidArgument, "four names");
  EXPECT_FAILS(RecordingEpisode::from_data(idf::Dict{{"format", "x"}}),
               StatusCode::kInvalidArgument, "'name'");
}

TEST(StreamEntity, DiffersWhereNamesDifferInTheirDotsAlone) {
  const auto of = [](const char* text) {
    return stream_entity("mcap", ltm::MemoryId::parse(text).value()).names()[3];
  };
  EXPECT_EQ(of("Vision/RGB/robot/head.cam"), "Vision.RGB.robot.head.cam");
  EXPECT_NE(of("Vision/RGB/robot.head/cam"), of("Vision/RGB/robot/head.cam"));
  EXPECT_NE(of("Vision/RGB/a.b/c"), of("Vision/RGB/a%2Eb/c"));
}

}  // namespace
}  // namespace engram::datasets
