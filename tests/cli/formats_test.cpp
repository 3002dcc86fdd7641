// SPDX-License-Identifier: Apache-2.0
// Recordings of other programs through `import --from` and `export`, there and back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "ltm/recording/recorder.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

constexpr int64_t kSteps = 12;
constexpr int64_t kPeriodNs = 50'000'000;  // As robomimic has it where files do not say.
const Time kStart = time_from_ns(1'600'000'000'000'000'000);

template <typename T>
idf::NdArray pixels(int64_t step, int64_t channels) {
  std::vector<T> values;
  for (int64_t i = 0; i < 6 * 8 * channels; ++i)
    values.push_back(static_cast<T>(i * i * 31 + step * 977));
  return idf::NdArray::take({6, 8, channels}, std::move(values));
}

/// What most robots record.
std::vector<std::pair<ltm::MemoryId, idf::Dict>> moment(int64_t step) {
  const auto id = [](const char* text) { return ltm::MemoryId::parse(text).value(); };
  const double at = static_cast<double>(step);
  return {
      {id("Vision/RGB/robot/cam"), {{"image", pixels<uint8_t>(step, 3)}}},
      {id("Vision/Depth/robot/cam"), {{"depth", pixels<uint16_t>(step, 1)}}},
      {id("RobotState/Proprioception/robot/arm"),
       {{"values", idf::NdArray::take({3}, std::vector<double>{at / 3, -at, 1e-9 * at})}}},
      {id("RobotState/Localization/robot/base"),
       {{"position", idf::NdArray::take({3}, std::vector<double>{at, 0.5, -0.25})},
        {"orientation", idf::NdArray::take({4}, std::vector<double>{1, 0, 0, 0})}}},
      {id("Skills/Commands/robot/arm"),
       {{"values", idf::NdArray::take({2}, std::vector<float>{static_cast<float>(step), 0.1F})}}},
  };
}

struct Format {
  std::string name;
  std::string file;
  std::vector<std::string> carries;  ///< Entities that come back with the values that they had.
  bool has_keys = false;             ///< It needs a file with keys beside it.
};

void PrintTo(const Format& format, std::ostream* out) {
  *out << format.name;
}

class RoundTrips : public ::testing::TestWithParam<Format> {
 protected:
  void SetUp() override {
    auto recorder = ltm::Recorder::open(directory_ / "0.engram", {});
    ASSERT_OK(recorder);
    for (int64_t step = 0; step < kSteps; ++step) {
      const Time time = kStart + Duration(step * kPeriodNs);
      ltm::Commit commit;
      for (auto& [entity, value] : moment(step))
        commit.updates.push_back({entity, time, {{std::move(value), {.created = time}}}});
      ASSERT_OK(recorder->commit(commit));
    }
    ASSERT_OK(recorder->close());
  }

  [[nodiscard]] std::string store(int i) const {
    return (directory_ / (std::to_string(i) + ".engram")).string();
  }

  /// Store `i` becomes a file, which becomes store `i` + 1.
  void pass_on(int i) const {
    // ALOHA's episodes are called as their files are.
    const std::filesystem::path folder = directory_ / std::to_string(i);
    std::filesystem::create_directory(folder);
    const std::string file = folder / GetParam().file;
    const RunResult out = run_engram(
        with_keys({"export", store(i), "@ all", "--to", GetParam().name, "-o", file}, i));
    ASSERT_EQ(out.exit_code, 0) << out.err;
    const RunResult in = run_engram(with_keys({"import", "--from", file, store(i + 1)}, i));
    ASSERT_EQ(in.exit_code, 0) << in.err;
  }

  /// The arguments, and the key file number `i` if the format has one.
  [[nodiscard]] std::vector<std::string> with_keys(std::vector<std::string> arguments,
                                                   int i) const {
    if (GetParam().has_keys)
      for (const std::string& word : {std::string("--keys"), keys(i)}) arguments.push_back(word);
    return arguments;
  }
  [[nodiscard]] std::string keys(int i) const {
    return (directory_ / (std::to_string(i) + ".keys")).string();
  }

  /// Of all snapshots.
  [[nodiscard]] Json recalled(int i, const std::string& names) const {
    const RunResult asked = run_engram({"query", store(i), names + " @ all", "--json"});
    EXPECT_EQ(asked.exit_code, 0) << asked.err;
    return Json::parse(asked.out).at("entities");
  }

  ScratchDirectory directory_;
};

std::vector<Json> values(const Json& entities) {
  std::vector<Json> all;
  for (const Json& snapshot : entities.at(0).at("snapshots"))
    all.push_back(snapshot.at("instances").at(0).at("data"));
  return all;
}

TEST_P(RoundTrips, LoseNothingThatTheFormatHolds) {
  ASSERT_NO_FATAL_FAILURE(pass_on(0));
  for (const std::string& names : GetParam().carries) {
    const std::string entity = names.substr(0, names.find('>'));
    const std::string back = names.substr(names.find('>') + 1);
    EXPECT_EQ(values(recalled(0, entity)), values(recalled(1, back))) << entity;
  }
}

TEST_P(RoundTrips, ChangeNothingTheSecondTime) {
  ASSERT_NO_FATAL_FAILURE(pass_on(0));
  ASSERT_NO_FATAL_FAILURE(pass_on(1));
  const Json once = recalled(1, ".*"), twice = recalled(2, ".*");
  EXPECT_GE(once.size(), GetParam().carries.size());
  ASSERT_EQ(once.size(), twice.size());
  for (size_t i = 0; i < once.size(); ++i) EXPECT_EQ(once[i], twice[i]) << once[i].at("id");
}

TEST_P(RoundTrips, SayFirstWhatIsNotHeld) {
  const std::string file = directory_ / GetParam().file;
  const RunResult dry = run_engram(with_keys(
      {"export", store(0), "@ all", "--to", GetParam().name, "-o", file, "--dry-run"}, 0));
  EXPECT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_FALSE(std::filesystem::exists(file));
  if (GetParam().name == "tum") {
    EXPECT_THAT(dry.out, HasSubstr("Skills/Commands/robot/arm"));
  }
  if (GetParam().name == "rosbag") {
    EXPECT_THAT(dry.out, HasSubstr("written as JSON in std_msgs/String"));
  }
}

TEST_P(RoundTrips, NameFilesThatAreNotWhatTheySay) {
  const std::string file = directory_ / GetParam().file;
  std::ofstream(file) << "hello";
  for (const bool is_empty : {false, true}) {
    if (is_empty) std::ofstream(file, std::ios::trunc).close();
    const RunResult in =
        run_engram(with_keys({"import", "--from", file, "--format", GetParam().name, store(1)}, 0));
    EXPECT_EQ(in.exit_code, 1);
    EXPECT_THAT(in.err, HasSubstr(GetParam().file));
    EXPECT_FALSE(std::filesystem::exists(store(1))) << "nothing came in";
  }
}

const std::string kImages = "Vision/RGB/robot/cam>Vision/RGB/.*/.*";
const std::string kDepth = "Vision/Depth/robot/cam>Vision/Depth/.*/.*";

// What formats of messages give back under its own name.
const std::vector<std::string> kAll = {
    "Vision/RGB/robot/cam", "Vision/Depth/robot/cam", "RobotState/Proprioception/robot/arm",
    "RobotState/Localization/robot/base", "Skills/Commands/robot/arm"};

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrips,
                         ::testing::Values(Format{"mcap", "robot.mcap", kAll},
                                           Format{"rosbag", "robot.bag", kAll},
                                           Format{"robomimic", "robot.hdf5", {kImages, kDepth}},
                                           Format{"aloha", "robot.hdf5", {kImages}},
                                           Format{"tum",
                                                  "robot",
                                                  {kImages, kDepth,
                                                   "RobotState/Localization/robot/base>"
                                                   "RobotState/Localization/robot/groundtruth"}},
                                           Format{"vault", "robot.vault", kAll, true}),
                         [](const auto& format) { return format.param.name; });

}  // namespace
}  // namespace engram::cli
