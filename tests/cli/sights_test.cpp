// SPDX-License-Identifier: Apache-2.0
// `engram learn-sights` and `engram notice-sights`, from images to answers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

/// A store with two short kitchens, whose images a night turned into latents, and a network that
/// hardly learned.
class Sights : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchDirectory();
    ASSERT_EQ(run({"simulate", "kitchen", store(), "--seed", "1,2", "--colours", "--fast",
                   "--seconds", "1.5", "--progress", "none"}),
              0);
    ASSERT_EQ(run({"consolidate", store(), "--entity", "Vision/RGB/.*", "--representation",
                   "latents", "--steps", "4", "--progress", "none"}),
              0);
    const RunResult learned = run_engram(
        {"learn-sights", store(), "--out", network(), "--budget", "2s", "--copies", "1", "--json"});
    ASSERT_EQ(learned.exit_code, 0) << learned.err;
    report_ = Json::parse(learned.out);
  }
  static void TearDownTestSuite() { delete folder_; }

  static int run(const std::vector<std::string>& words) {
    const RunResult result = run_engram(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code;
  }
  static std::string store() { return *folder_ / "kitchens.engram"; }
  static std::string network() { return *folder_ / "kitchens.sights"; }

  static inline ScratchDirectory* folder_ = nullptr;
  static inline Json report_;
};

TEST_F(Sights, AreLearnedFromAllImagesButThoseOfTheLastRecording) {
  EXPECT_EQ(report_["images"], 60);
  EXPECT_EQ(report_["copies"], 30);
  EXPECT_EQ(report_["recordings"], 2);
  EXPECT_EQ(report_["held_out"], 1);
  EXPECT_GT(report_["steps"], 0);
  EXPECT_TRUE(std::filesystem::exists(network()));
}

TEST_F(Sights, AreNotToldOfThingsThatAreKnownBetter) {
  const RunResult found = run_engram({"notice-sights", store(), "--network", network(), "--json"});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  // Both kitchens together have the poses of all that was learned.
  const Json told = Json::parse(found.out);
  EXPECT_GT(told["known"].size(), 6U);
  EXPECT_EQ(told["images"], 60);
  EXPECT_EQ(told["sightings"], Json::array());
}

TEST_F(Sights, AreCommittedOnceWithTheirImagesAsEvidence) {
  const std::string other = *folder_ / "forgetful.engram";
  std::filesystem::copy(store(), other, std::filesystem::copy_options::recursive);
  ASSERT_EQ(run({"forget", other, "Objects/Instances", "--yes"}), 0);
  const std::vector<std::string> words{"notice-sights", other,      "--network",
                                       network(),       "--commit", "--json"};
  const RunResult first = run_engram(words);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const Json found = Json::parse(first.out);
  EXPECT_EQ(found["images"], 60);
  ASSERT_GT(found["sightings"].size(), 0U);
  EXPECT_EQ(found["committed"], found["sightings"].size());
  const RunResult again = run_engram(words);
  EXPECT_EQ(Json::parse(again.out)["committed"], 0) << again.err;

  const std::string kind = found["sightings"].back()["kind"];
  const std::string name = kind.substr(kind.rfind('/') + 1);
  const RunResult told =
      run_engram({"query", other, "Objects/Sightings/seen/" + name + "_1 @ latest", "--json"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("Vision/RGB/head/stereo/"));
  EXPECT_THAT(told.out, HasSubstr("\"colour\""));
  std::string words_of_kind = name;
  std::replace(words_of_kind.begin(), words_of_kind.end(), '_', ' ');
  const RunResult asked =
      run_engram({"ask", other, "Where did you last see the " + words_of_kind + "?", "--json"});
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  EXPECT_THAT(asked.out, HasSubstr("Vision/RGB/head/stereo/")) << "the image that showed it";
  const RunResult moved =
      run_engram({"ask", other, "Was the " + words_of_kind + " moved?", "--json"});
  EXPECT_THAT(moved.out, HasSubstr("Vision/RGB/head/stereo/"));
  EXPECT_EQ(run({"check", other}), 0);
}

TEST_F(Sights, SayWhatIsWrong) {
  const std::string plain = *folder_ / "plain.engram";
  ASSERT_EQ(
      run({"simulate", "kitchen", plain, "--no-images", "--seconds", "1", "--progress", "none"}),
      0);
  const RunResult unread = run_engram({"notice-sights", plain, "--network", network()});
  EXPECT_EQ(unread.exit_code, 1);
  EXPECT_THAT(unread.err, HasSubstr("no entity has images as latents"));
  const RunResult unlearned =
      run_engram({"learn-sights", plain, "--out", *folder_ / "none.sights", "--budget", "1s"});
  EXPECT_EQ(unlearned.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(*folder_ / "none.sights"));
  EXPECT_EQ(run_engram({"learn-sights", store(), "--out", "x", "--copies", "99"}).exit_code, 2);
}

}  // namespace
}  // namespace engram::cli
