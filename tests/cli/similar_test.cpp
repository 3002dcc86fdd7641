// SPDX-License-Identifier: Apache-2.0
// `engram similar`: what it finds, keeps and refuses; nights make its codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

/// The same recording twice, an hour apart: each moment is there once more.
class SimilarCommand : public ::testing::Test {
 protected:
  SimilarCommand() {
    const Recording recording = make_recording(directory_.path(), 8);
    for (const char* start : {"2022-02-18 13:00:00", "2022-02-18 14:00:00"})
      EXPECT_EQ(run_engram(import_arguments(recording, store_, start)).exit_code, 0);
  }

  [[nodiscard]] static Json found(const RunResult& result) {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out, nullptr, false);
  }

  ScratchDirectory directory_;
  std::string store_ = directory_.path() / "store";
  const std::string moment_ = kCamera + "/2022-02-18 13:00:05";
};

TEST_F(SimilarCommand, FindsTheSameMomentOfTheOtherRecording) {
  const Json answer = found(run_engram({"similar", store_, moment_, "--elsewhere", "--json"}));
  EXPECT_EQ(answer.at("moments").at(0).at("id"), kCamera + "/2022-02-18 14:00:05.000000");
  EXPECT_EQ(answer.at("moments").at(0).at("distance"), 0);
  EXPECT_EQ(answer.at("compared"), 80);
  EXPECT_EQ(answer.at("computed"), 80);
  const RunResult text = run_engram({"similar", store_, moment_, "-k", "2"});
  EXPECT_THAT(text.out, HasSubstr("2022-02-18 14:00:05.000000     0.000"));
  EXPECT_THAT(text.out, HasSubstr("80 images had no code yet"));
}

TEST_F(SimilarCommand, KeepsCodesAndNightsMakeThem) {
  EXPECT_EQ(found(run_engram({"similar", store_, moment_, "--keep", "--json"})).at("computed"), 0);
  const RunResult night = run_engram({"consolidate", store_, "--representation", "video",
                                      "--entity", kCamera, "--drop-raw", "--json"});
  const Json report = found(night);
  ASSERT_EQ(report.at("codes").size(), 1u);
  // What was coded as it was recorded is not coded again.
  EXPECT_EQ(report.at("codes").at(0).at("kept"), 80);
  EXPECT_EQ(report.at("codes").at(0).at("coded"), 0);
  const Json answer = found(run_engram({"similar", store_, moment_, "--elsewhere", "--json"}));
  EXPECT_EQ(answer.at("computed"), 0);
  EXPECT_EQ(answer.at("moments").at(0).at("id"), kCamera + "/2022-02-18 14:00:05.000000");
  EXPECT_EQ(run_engram({"check", store_}).exit_code, 0);
}

TEST_F(SimilarCommand, FindsWhatWasImportedSinceWithoutDecodingIt) {
  EXPECT_EQ(run_engram({"similar", store_, moment_, "--keep"}).exit_code, 0);
  const Recording recording = make_recording(directory_.path(), 8);
  EXPECT_EQ(run_engram(import_arguments(recording, store_, "2022-02-18 15:00:00")).exit_code, 0);
  const Json answer = found(run_engram({"similar", store_, moment_, "--elsewhere", "--json"}));
  EXPECT_EQ(answer.at("compared"), 120);
  EXPECT_EQ(answer.at("computed"), 0);
}

TEST_F(SimilarCommand, FindsAnImageAndDrawsWhatItFound) {
  const std::string saved = directory_.path() / "saved";
  EXPECT_EQ(
      run_engram({"query", store_, kCamera + " @ 2022-02-18 13:00:05", "--save", saved}).exit_code,
      0);
  std::string image;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(saved))
    if (entry.path().extension() == ".png") image = entry.path();
  const std::string picture = directory_.path() / "found.png";
  const Json answer = found(run_engram({"similar", store_, image, "--json", "--picture", picture}));
  EXPECT_THAT(answer.at("moments").at(0).at("id").get<std::string>(), HasSubstr(":00:05.000000"));
  EXPECT_GT(std::filesystem::file_size(picture), 1000u);
  EXPECT_THAT(run_engram({"similar", store_, picture}).err, HasSubstr("found an image of"));
}

TEST_F(SimilarCommand, AsksAServerAsItAsksAStore) {
  const std::string endpoint = "unix:" + (directory_.path() / "s").string();
  const std::string served = directory_.path() / "served";
  std::filesystem::copy(store_, served, std::filesystem::copy_options::recursive);
  RunningEngram server({"serve", served, "--listen", endpoint, "--no-system-state"});
  ASSERT_TRUE(server.wait_for("listens at"));
  const auto ask = [&](std::vector<std::string> arguments) {
    std::vector<std::string> store{"similar", store_}, remote{"similar", "--server", endpoint};
    store.insert(store.end(), arguments.begin(), arguments.end());
    remote.insert(remote.end(), arguments.begin(), arguments.end());
    Json expected = found(run_engram(store)), told = found(run_engram(remote));
    // A server keeps what it computed for the question before.
    expected.erase("computed");
    told.erase("computed");
    EXPECT_EQ(told, expected);
    return told;
  };
  EXPECT_EQ(ask({moment_, "--json", "--elsewhere"}).at("compared"), 80);
  ask({kCamera, "--json", "-k", "3", "--with", kJoints + "=0.5"});
  ask({kJoints, "--json", "--one-per-recording"});
  EXPECT_EQ(ask({moment_, "Vision @ 0..19", "--json"}).at("compared"), 20);
  const std::string saved = directory_.path() / "saved", picture = directory_.path() / "a.png";
  EXPECT_EQ(run_engram({"query", store_, kCamera + " @ latest", "--save", saved}).exit_code, 0);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(saved))
    if (entry.path().extension() == ".png") {
      ask({entry.path(), "--json"});
      EXPECT_EQ(run_engram({"similar", "--server", endpoint, entry.path(), "--picture", picture})
                    .exit_code,
                0);
    }
  EXPECT_GT(std::filesystem::file_size(picture), 1000u);
  const RunResult keep = run_engram({"similar", "--server", endpoint, moment_, "--keep"});
  EXPECT_EQ(keep.exit_code, kWrongUsage);
  EXPECT_THAT(keep.err, HasSubstr("--keep is of stores"));
  const RunResult both = run_engram({"similar", store_, "--server", endpoint, moment_, "Vision"});
  EXPECT_EQ(both.exit_code, kWrongUsage);
  EXPECT_THAT(run_engram({"similar", "--server", endpoint, kCamera + "/2022-02-18 13:00:05.1"}).err,
              HasSubstr("the moment before it is"));
  EXPECT_EQ(server.end(SIGTERM).exit_code, 0);
}

TEST_F(SimilarCommand, SaysWhatIsWrong) {
  const auto refuses = [this](std::vector<std::string> arguments, int code, const char* why) {
    arguments.insert(arguments.begin(), {"similar", store_});
    const RunResult result = run_engram(arguments);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(why));
  };
  refuses({kCamera + "/2022-02-18 13:00:05.1"}, kFailed, "the moment before it is");
  refuses({"Vision/RGB/head/other"}, kFailed, "Vision/RGB/head/other");
  refuses({"Vision/RGB"}, kWrongUsage, "needs a moment, an entity or an image file");
  refuses({"missing.png"}, kFailed, "missing.png");
  refuses({moment_, "Vision @ sometimes"}, kWrongUsage, "sometimes");
  refuses({moment_, "RobotState @ all"}, kFailed, "selects nothing of");
  refuses({moment_, "--with", kJoints + "=much"}, kWrongUsage, "'much' is no number");
  refuses({moment_, "--with", kJoints + "=0"}, kFailed, "must be above 0");
  refuses({moment_, "--entity", kJoints}, kWrongUsage, "is for images");
  refuses({moment_, "--context", "-1s"}, kWrongUsage, "must not be negative");
}

}  // namespace
}  // namespace engram::cli
