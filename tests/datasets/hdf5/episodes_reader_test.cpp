// SPDX-License-Identifier: Apache-2.0
#include "datasets/hdf5/episodes_reader.h"

#include "ltm/core/file.h"
#include "tests/datasets/hdf5/hdf5_fixtures.h"

namespace engram::datasets {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Recording {
  std::vector<RecordingReader::Moment> moments;
  std::vector<RecordingStream> streams;
  ReadingReport report;
  uint64_t total = 0;
};

Result<Recording> read_all(std::string_view format, const std::filesystem::path& path,
                           const ReadingOptions& options = {}) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, hdf5_format(format)->open(path, options));
  Recording recording;
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(auto moment, reader->next());
    if (!moment) break;
    recording.moments.push_back(*std::move(moment));
  }
  recording.streams = reader->streams();
  recording.report = reader->report();
  recording.total = reader->total();
  return recording;
}

std::vector<std::string> entities_of(const Recording& recording) {
  std::vector<std::string> names;
  for (const RecordingStream& stream : recording.streams)
    names.push_back(stream.entity.to_string());
  return names;
}

TEST(EpisodesReader, GivesEachArrayOfRobomimicItsEntity) {
  const ScratchDirectory scratch;
  ASSERT_OK(testing::write_robomimic(scratch / "a.hdf5", testing::kEnvArgs));
  const auto recording = read_all("robomimic", scratch / "a.hdf5");
  ASSERT_OK(recording);
  EXPECT_THAT(entities_of(*recording),
              ElementsAre("Skills/Commands/robot/actions", "Tasks/Feedback/robot/dones",
                          "Vision/RGB/robot/next_obs.front_image", "Vision/RGB/robot/front_image",
                          "RobotState/Proprioception/robot/robot0_joint_pos"));
  EXPECT_EQ(recording->total, 35u);
  EXPECT_EQ(recording->report, ReadingReport());
  const auto& updates = recording->moments[0].commit.updates;
  ASSERT_EQ(updates.size(), 5u);
  EXPECT_EQ(updates[0].instances[0].data.at("values")->get<idf::NdArray>().shape(), idf::Shape{7});
  EXPECT_TRUE(updates[1].instances[0].data.at("value")->is<int64_t>());
  EXPECT_EQ(updates[3].instances[0].data.at("image")->get<idf::NdArray>().shape(),
            (idf::Shape{4, 6, 3}));
  EXPECT_EQ(updates[0].instances[0].metadata.provider, "import");
}

TEST(EpisodesReader, TimesFollowTheControlRateAndEpisodesOneAnother) {
  const ScratchDirectory scratch;
  ASSERT_OK(testing::write_robomimic(scratch / "a.hdf5", testing::kEnvArgs));
  const Time start = time_from_ns(5'000'000'000);
  const auto recording = read_all("robomimic", scratch / "a.hdf5", {.start = start});
  ASSERT_OK(recording);
  std::vector<double> seconds;
  std::vector<std::string> episodes;
  for (const auto& moment : recording->moments) {
    seconds.push_back(to_seconds(moment.commit.updates[0].time - start));
    if (moment.begins) episodes.push_back(moment.begins->name);
  }
  EXPECT_THAT(seconds, ElementsAre(0, 0.1, 0.2, 0.3, 10.3, 10.4, 10.5));
  EXPECT_THAT(episodes, ElementsAre("demo_0", "demo_1"));
  EXPECT_EQ(*recording->moments[0].begins->attributes.find("attributes")->at("model_file"),
            idf::Data("<mujoco/>"));
}

TEST(EpisodesReader, AnAssumedRateIsSaid) {
  const ScratchDirectory scratch;
  for (const char* env : {"{}", "no JSON", "[1]", R"({"env_kwargs": 5})"}) {
    std::filesystem::remove(scratch / "a.hdf5");
    ASSERT_OK(testing::write_robomimic(scratch / "a.hdf5", env));
    const auto recording = read_all("robomimic", scratch / "a.hdf5");
    ASSERT_OK(recording);
    EXPECT_EQ(recording->report.not_carried.at("times: no rate in the file, 20 Hz assumed"), 1u);
  }
  const auto stated = read_all("robomimic", scratch / "a.hdf5", {.rate_hz = 5});
  ASSERT_OK(stated);
  EXPECT_TRUE(stated->report.not_carried.empty());
}

TEST(EpisodesReader, ReadsChosenEpisodesAlone) {
  const ScratchDirectory scratch;
  ASSERT_OK(testing::write_robomimic(scratch / "a.hdf5", testing::kEnvArgs));
  const auto recording = read_all("robomimic", scratch / "a.hdf5", {.episodes = {"demo_1"}});
  ASSERT_OK(recording);
  EXPECT_EQ(recording->moments.size(), 3u);
  EXPECT_FAILS(read_all("robomimic", scratch / "a.hdf5", {.episodes = {"demo_7"}}),
               StatusCode::kNotFound, "demo_7");
}

TEST(EpisodesReader, FormatsKnowTheirFiles) {
  const ScratchDirectory scratch;
  ASSERT_OK(testing::write_robomimic(scratch / "a.hdf5", testing::kEnvArgs));
  ASSERT_OK(testing::write_aloha(scratch / "b.hdf5", 2));
  std::filesystem::create_directory(scratch / "episodes");
  ASSERT_OK(testing::write_aloha(scratch / "episodes" / "episode_0.hdf5", 2));
  overwrite_file(scratch / "c.hdf5", as_bytes("no HDF5"));
  const auto known = [&](std::string_view format) {
    std::vector<bool> is_known;
    for (const char* name : {"a.hdf5", "b.hdf5", "episodes", "c.hdf5", "nothing.hdf5"})
      is_known.push_back(hdf5_format(format)->recognises(scratch / name));
    return is_known;
  };
  EXPECT_THAT(known("robomimic"), ElementsAre(true, false, false, false, false));
  EXPECT_THAT(known("aloha"), ElementsAre(false, true, true, false, false));
}

TEST(EpisodesReader, ErrorsNameFileAndWhatIsNeeded) {
  const ScratchDirectory scratch;
  ASSERT_OK(testing::write_robomimic(scratch / "a.hdf5", testing::kEnvArgs));
  ASSERT_OK(testing::write_aloha(scratch / "b.hdf5", 2));
  EXPECT_FAILS(read_all("robomimic", scratch / "b.hdf5"), StatusCode::kInvalidArgument,
               "has no group '/data'");
  EXPECT_FAILS(read_all("aloha", scratch / "a.hdf5"), StatusCode::kInvalidArgument, "'/action'");
  EXPECT_FAILS(read_all("aloha", scratch / "x.hdf5"), StatusCode::kNotFound, "x.hdf5");
  EXPECT_FAILS(read_all("robomimic", scratch / "a.hdf5", {.rate_hz = 1e9}),
               StatusCode::kInvalidArgument, "needs 0.001 to");
  EXPECT_FAILS(read_all("robomimic", scratch / "a.hdf5", {.episode_gap = Duration(0)}),
               StatusCode::kInvalidArgument, "more than 0s");
}

TEST(EpisodesReader, DamagedFilesAreErrors) {
  const ScratchDirectory scratch;
  ASSERT_OK(testing::write_robomimic(scratch / "a.hdf5", testing::kEnvArgs));
  const auto whole = read_file(scratch / "a.hdf5");
  ASSERT_OK(whole);
  const std::vector<std::byte> good(whole->bytes().begin(), whole->bytes().end());
  for (size_t at = 0; at < good.size(); at += 64) {
    std::vector<std::byte> bad = good;
    bad[at] ^= std::byte{0xFF};
    overwrite_file(scratch / "bad.hdf5", bad);
    (void)read_all("robomimic", scratch / "bad.hdf5");
  }
  for (size_t size = 0; size < good.size(); size += 512) {
    overwrite_file(scratch / "bad.hdf5", std::span(good).first(size));
    EXPECT_FAILS(read_all("robomimic", scratch / "bad.hdf5"), StatusCode::kDataLoss, "bad.hdf5");
  }
}

}  // namespace
}  // namespace engram::datasets
