// SPDX-License-Identifier: Apache-2.0
// The journey of the README, by the program itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using Json = nlohmann::json;

Json json_of(const RunResult& result) {
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return Json::parse(result.out);
}

/// The camera's entry of `engram info`.
Json camera_info(const std::string& store) {
  const Json info = json_of(run_engram({"info", store, "--json"}));
  for (const Json& entity : info.at("entities"))
    if (entity.at("id") == kCamera) return entity;
  return {};
}

class Journey : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = new ScratchDirectory();
    store_ = directory_->path() / "robot.engram";
    const Recording recording = make_recording(directory_->path(), 12);
    const RunResult imported = run_engram(import_arguments(recording, store_));
    ASSERT_EQ(imported.exit_code, 0) << imported.err;
    const RunResult trained = run_engram({"consolidate", store_, "--representation", "latents",
                                          "--steps", "120", "--threads", "1", "--json"});
    ASSERT_EQ(trained.exit_code, 0) << trained.err;
    consolidated_ = Json::parse(trained.out);
  }
  static void TearDownTestSuite() { delete directory_; }

  static inline ScratchDirectory* directory_ = nullptr;
  static inline std::string store_;
  static inline Json consolidated_;
};

TEST_F(Journey, FiltersToFiveHertzAndCountsWhatWasDropped) {
  const Json camera = camera_info(store_);
  EXPECT_EQ(camera.at("offered_snapshots"), 180);
  EXPECT_EQ(camera.at("snapshots"), 60);
  EXPECT_NEAR(camera.at("rate_hz").get<double>(), 5, 0.01);
  EXPECT_GT(camera.at("offered_bytes").get<uint64_t>(), 180u * 64 * 64 * 3);
  EXPECT_LT(camera.at("stored_bytes").get<uint64_t>(), camera.at("raw_bytes").get<uint64_t>());
}

TEST(Import, StoresTypesAndRefusesWhatBreaksThem) {
  const ScratchDirectory directory;
  const std::string types = directory / "types.xml";
  std::ofstream(types) << R"(<AronTypeDefinition><GenerateTypes>
    <Object name="robot::View"><ObjectChild key="image"><Image pixelType="rgb24"/></ObjectChild>
    <ObjectChild key="state"><MemoryLink/></ObjectChild></Object>
    <Object name="robot::Depth"><ObjectChild key="image"><Image pixelType="depth16"/></ObjectChild></Object>
    </GenerateTypes></AronTypeDefinition>)";
  const Recording recording = make_recording(directory.path(), 1);
  const auto import_as = [&](const std::string& store, const std::string& type) {
    auto arguments = import_arguments(recording, directory / store);
    for (const auto& extra : {std::string("--types"), types, std::string("--type"), type})
      arguments.push_back(extra);
    return run_engram(arguments);
  };
  const RunResult taken = import_as("good", "Vision/RGB=robot::View");
  ASSERT_EQ(taken.exit_code, 0) << taken.err;
  const Json info = json_of(run_engram({"info", directory / "good", "--json"}));
  EXPECT_THAT(info.at("types").at("Vision/RGB").get<std::string>(), HasSubstr("robot::View"));
  const RunResult refused = import_as("bad", "Vision/RGB=robot::Depth");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("'image'"));
  const RunResult unknown = import_as("none", "Vision/RGB=robot::Nothing");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("robot::View robot::Depth"));
}

TEST_F(Journey, ConsolidationStoresLatentsOfEveryEntityWithTheirMeasuredError) {
  ASSERT_EQ(consolidated_.at("entities").size(), 2u);
  const Json camera = camera_info(store_);
  EXPECT_EQ(camera.at("latent_snapshots"), 60);
  EXPECT_GT(camera.at("model_bytes").get<uint64_t>(), 0u);
  EXPECT_GT(camera.at("psnr_mean_over_images_db").get<double>(), 20);
  EXPECT_GT(camera.at("psnr_pooled_error_db").get<double>(), 20);
}

TEST_F(Journey, AnswersFromTheRecordedFormFirst) {
  const Json answer = json_of(run_engram({"query", store_, kCamera + " @ latest:3", "--json"}));
  const Json& snapshots = answer.at("entities").at(0).at("snapshots");
  ASSERT_EQ(snapshots.size(), 3u);
  for (const Json& snapshot : snapshots) EXPECT_EQ(snapshot.at("source"), "recorded");
  const Json& data = snapshots.at(2).at("instances").at(0).at("data");
  EXPECT_EQ(data.at("image").at("$ndarray").at("shape"), Json({64, 64, 3}));
  EXPECT_EQ(data.at("state"), kJoints + "/2022-02-18 13:00:11.800000");
}

TEST_F(Journey, SavesImagesAsPngAndDataAsJson) {
  const std::string save = directory_->path() / "answers";
  const RunResult saved =
      run_engram({"query", store_, kCamera + " @ latest:2", "--prefer", "latent", "--save", save});
  ASSERT_EQ(saved.exit_code, 0) << saved.err;
  EXPECT_THAT(saved.out, HasSubstr("reconstructed"));
  const std::string base = save + "/" + kCamera + "/2022-02-18T13-00-11.800000";
  std::ifstream png(base + ".image.png", std::ios::binary);
  std::string signature(4, '\0');
  ASSERT_TRUE(png.read(signature.data(), 4));
  EXPECT_EQ(signature, "\x89PNG");
  std::ifstream text(base + ".json");
  const Json data = Json::parse(text);
  EXPECT_EQ(data.at("source"), "reconstructed");
  EXPECT_EQ(data.at("model"), kCamera + " v1");
  EXPECT_EQ(data.at("instances").at(0).at("data").at("image").at("$file"),
            "2022-02-18T13-00-11.800000.image.png");
}

TEST_F(Journey, PredictsTheFuture) {
  const Json answer = json_of(run_engram({"query", store_, ".*/.*/.*/.* @ +200ms", "--json"}));
  ASSERT_EQ(answer.at("entities").size(), 2u);
  for (const Json& entity : answer.at("entities")) {
    const Json& snapshot = entity.at("snapshots").at(0);
    EXPECT_EQ(snapshot.at("source"), "predicted");
    // Numbers are answered by whatever was best on these few.
    if (entity.at("id") == kCamera) {
      // A model of so short a training may copy, and is called so then.
      EXPECT_THAT(snapshot.at("predictor").get<std::string>(), AnyOf("deep", "copy-last"));
    }
    EXPECT_NE(snapshot.at("predictor"), "");
    EXPECT_DOUBLE_EQ(snapshot.at("horizon_s").get<double>(), 0.2);
    EXPECT_THAT(snapshot.at("id").get<std::string>(), HasSubstr("2022-02-18 13:00:12.000000"));
  }
  const Json far = json_of(run_engram({"query", store_, kCamera + " @ 2022-02-18 13:00:12.2", "--json"}));
  EXPECT_EQ(far.at("entities").at(0).at("snapshots").at(0).at("source"), "predicted");
}

TEST_F(Journey, EvaluatesBesideCopyLastInBothConventions) {
  const std::string picture = directory_->path() / "eval.png";
  const RunResult shown = run_engram({"eval", store_, "--picture", picture});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  for (const char* text : {"mean over images", "pooled error", "reconstruction", "predicted 1 ahead",
                           "copy-last 1 ahead", "predicted 2 ahead", "RMSE"})
    EXPECT_THAT(shown.out, HasSubstr(text));
  EXPECT_GT(std::filesystem::file_size(picture), 1000u);
  const Json report = json_of(run_engram({"eval", store_, "--json"}));
  EXPECT_EQ(report.at("entities").size(), 2u);
}

TEST_F(Journey, ListsModelsAndWhatTheyAreMadeOf) {
  const RunResult shown = run_engram({"models", store_});
  for (const char* text : {"Vision/RGB/head/cam v1", "trained on 60 snapshots of 1 recordings",
                           "latents", "with 30,000"})
    EXPECT_THAT(shown.out, HasSubstr(text));
  const Json camera = json_of(run_engram({"models", store_, "--entity", "Vision", "--json"}));
  ASSERT_EQ(camera.at("models").size(), 1u);
  EXPECT_EQ(camera.at("models").at(0).at("images").at("latent_rows"), 60);
  EXPECT_EQ(run_engram({"models", store_, "--entity", "Nothing"}).exit_code, 1);
}

TEST(Representation, KeepsImagesAsVideoWhereNetworksCannotPay) {
  const ScratchDirectory directory;
  const std::string store = directory.path() / "robot.engram";
  ASSERT_EQ(run_engram(import_arguments(make_recording(directory.path(), 8), store)).exit_code, 0);
  const Json done = json_of(run_engram({"consolidate", store, "--steps", "20", "--threads", "1",
                                        "--psnr", "34", "--json"}));
  for (const Json& entity : done.at("entities")) {
    if (entity.at("entity") != kCamera) continue;
    EXPECT_GE(entity.at("psnr_minimum_db").get<double>(), 34);
    EXPECT_EQ(entity.at("images").at("latent_rows"), 0);
    EXPECT_EQ(entity.at("images").at("rows"), 40);
    EXPECT_LT(entity.at("latent_bytes").get<int>(), entity.at("stored_bytes").get<int>());
  }
  const Json answer = json_of(
      run_engram({"query", store, kCamera + " @ latest:3", "--prefer", "latent", "--json"}));
  EXPECT_EQ(answer.at("entities").at(0).at("snapshots").at(0).at("source"), "reconstructed");
  EXPECT_EQ(run_engram({"query", store, kCamera + " @ +200ms"}).exit_code, 0);
}

TEST_F(Journey, TrainsOnlyWhereSomethingIsNew) {
  const Json again = json_of(run_engram({"consolidate", store_, "--steps", "1", "--json"}));
  for (const Json& entity : again.at("entities")) EXPECT_TRUE(entity.contains("skipped")) << entity;
}

TEST(DroppingRawData, KeepsTheMemoryAnsweringFromLatents) {
  const ScratchDirectory directory;
  const std::string store = directory.path() / "robot.engram";
  ASSERT_EQ(run_engram(import_arguments(make_recording(directory.path(), 8), store)).exit_code, 0);
  const RunResult dropped =
      run_engram({"consolidate", store, "--representation", "latents", "--steps", "60", "--threads",
                  "1", "--entity", kCamera, "--drop-raw", "--json"});
  ASSERT_EQ(dropped.exit_code, 0) << dropped.err;
  EXPECT_EQ(Json::parse(dropped.out).at("dropped").at(0).at("snapshots"), 40);
  const Json camera = camera_info(store);
  EXPECT_EQ(camera.at("snapshots"), 40);
  EXPECT_EQ(camera.at("recorded_snapshots"), 0);
  EXPECT_EQ(camera.at("offered_snapshots"), 120);
  const Json answer = json_of(run_engram({"query", store, kCamera + " @ all", "--json"}));
  const Json& snapshots = answer.at("entities").at(0).at("snapshots");
  ASSERT_EQ(snapshots.size(), 40u);
  for (const Json& snapshot : snapshots) EXPECT_EQ(snapshot.at("source"), "reconstructed");
  // The joints were not consolidated: they are all there as they were recorded.
  const Json joints = json_of(run_engram({"query", store, kJoints + " @ all", "--json"}));
  EXPECT_EQ(joints.at("entities").at(0).at("snapshots").size(), 40u);
  EXPECT_EQ(joints.at("entities").at(0).at("snapshots").at(0).at("source"), "recorded");
}

}  // namespace
}  // namespace engram::cli
