// SPDX-License-Identifier: Apache-2.0
// `engram augment`, and what the other commands make of its stores.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

class Augment : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = new ScratchDirectory();
    store_ = directory_->path() / "robot.engram";
    changed_ = directory_->path() / "changed.engram";
    const Recording recording = make_recording(directory_->path(), 8);
    const RunResult imported = run_engram(import_arguments(recording, store_));
    ASSERT_EQ(imported.exit_code, 0) << imported.err;
    made_ = run_engram({"augment", store_, "--copies", "2", "--seed", "5", "--out", changed_,
                        "--picture", directory_->path() / "changes.png", "--json"});
    ASSERT_EQ(made_.exit_code, 0) << made_.err;
  }
  static void TearDownTestSuite() { delete directory_; }

  static inline ScratchDirectory* directory_ = nullptr;
  static inline std::string store_, changed_;
  static inline RunResult made_;
};

TEST_F(Augment, TellsWhatItMade) {
  const Json report = Json::parse(made_.out);
  EXPECT_EQ(report.at("source"), "augmented");
  for (const Json& entity : report.at("entities")) {
    if (entity.at("id") == kCamera) {
      EXPECT_EQ(entity.at("snapshots"), 40);
      EXPECT_EQ(entity.at("instances"), 80);
    } else {
      EXPECT_EQ(entity.at("skipped_reason"), "no recorded snapshot with images");
    }
  }
  EXPECT_GT(std::filesystem::file_size(directory_->path() / "changes.png"), 1000u);
}

TEST_F(Augment, IsNeverTakenForReal) {
  const RunResult text = run_engram({"query", changed_, "Vision @ latest:3"});
  EXPECT_THAT(text.out, HasSubstr("augmented"));
  EXPECT_EQ(text.out.find("recorded"), std::string::npos);
  const Json answer = Json::parse(run_engram({"query", changed_, "Vision @ latest", "--json"}).out);
  const Json& snapshot = answer.at("entities")[0].at("snapshots")[0];
  EXPECT_EQ(snapshot.at("source"), "augmented");
  const Json& instance = snapshot.at("instances")[1];
  EXPECT_THAT(instance.at("origin").get<std::string>(), HasSubstr("Vision/RGB/head/cam/"));
  EXPECT_FALSE(instance.at("recipe").at("changes").empty());
  const Json info = Json::parse(run_engram({"info", changed_, "--json"}).out);
  EXPECT_EQ(info.at("entities")[0].at("augmented_snapshots"), 40);
  const RunResult trained = run_engram({"consolidate", changed_, "--steps", "10"});
  EXPECT_THAT(trained.out, HasSubstr("40 are augmented, which no model encodes"));
}

TEST_F(Augment, MakesTheSameImagesAgain) {
  const std::string again = directory_->path() / "again.engram";
  ASSERT_EQ(run_engram({"augment", store_, "--copies", "2", "--seed", "5", "-o", again}).exit_code,
            0);
  const auto images = [](const std::string& store) {
    return run_engram({"query", store, "Vision @ all", "--json"}).out;
  };
  EXPECT_EQ(images(changed_), images(again));
}

TEST_F(Augment, IsTrainedOnBesideRealOnes) {
  const RunResult trained =
      run_engram({"consolidate", store_, "--entity", kCamera, "--representation", "latents",
                  "--steps", "20", "--threads", "1", "--augmented", changed_, "--json"});
  ASSERT_EQ(trained.exit_code, 0) << trained.err;
  EXPECT_THAT(trained.out, HasSubstr("80 augmented values were trained on, too; 0 were made of"));
  EXPECT_EQ(Json::parse(trained.out).at("entities")[0].at("snapshots"), 40);
}

TEST_F(Augment, RendersMomentsAnew) {
  const std::string kitchen = directory_->path() / "kitchen.engram";
  ASSERT_EQ(run_engram({"simulate", "kitchen", kitchen, "--fast", "--seconds", "3"}).exit_code, 0);
  const std::string rendered = directory_->path() / "rendered.engram";
  const std::string picture = directory_->path() / "rendered.png";
  const RunResult made =
      run_engram({"augment", kitchen, "Vision/RGB @ all#0", "--render", "original,light",
                  "--render-every", "1s", "--hold", "50ms", "--render-samples", "2", "--out",
                  rendered, "--picture", picture, "--json"});
  if (made.err.find("found no program") != std::string::npos) GTEST_SKIP() << made.err;
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Json report = Json::parse(made.out);
  EXPECT_EQ(report.at("entities")[0].at("snapshots"), 3);
  EXPECT_EQ(report.at("entities")[0].at("instances"), 6);
  EXPECT_GT(std::filesystem::file_size(picture), 1000u);
  const RunResult checked = run_engram({"check", rendered});
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  const RunResult asked = run_engram({"query", rendered, "Vision @ all", "--json"});
  EXPECT_THAT(asked.out, HasSubstr("scene_light"));
  EXPECT_THAT(asked.out, HasSubstr("augmented"));
}

TEST_F(Augment, SaysWhatIsWrong) {
  const auto fails = [](const std::vector<std::string>& arguments, int code, const char* message) {
    const RunResult result = run_engram(arguments);
    EXPECT_EQ(result.exit_code, code);
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  const std::string other = directory_->path() / "other.engram";
  fails({"augment", store_, "--out", changed_}, 1, "needs a new place");
  fails({"augment", store_, "--out", other, "--changes", "blurr"}, 2, "did you mean 'blur'");
  fails({"augment", store_, "--out", other, "--changes", "recolour"}, 2, "where the object is");
  fails({"augment", store_, "--out", other, "--render", "fog"}, 2, "'fog'");
  fails({"augment", store_, "--out", other, "--render", "all", "--changes", "blur"}, 2, "excludes");
  fails({"augment", store_, "--out", other, "--render-width", "64"}, 2, "--render");
  fails({"augment", store_, "Audio", "--out", other}, 1, "matches 'Audio");
  fails({"augment", store_, "--out", other, "--copies", "0"}, 2, "needs 1 to 64");
  fails({"consolidate", store_, "--augmented", store_, "--steps", "5", "--force"}, 1,
        "is not augmented");
}

}  // namespace
}  // namespace engram::cli
