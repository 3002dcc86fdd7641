// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

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

/// A store of 130 snapshots with models of both entities: 20 are held out, ten of them calibrate.
class Predict : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = new ScratchDirectory();
    store_ = directory_->path() / "robot.engram";
    const Recording recording = make_recording(directory_->path(), 26);
    const RunResult imported = run_engram(import_arguments(recording, store_));
    ASSERT_EQ(imported.exit_code, 0) << imported.err;
    const RunResult trained = run_engram(
        {"consolidate", store_, "--representation", "latents", "--steps", "60", "--threads", "1"});
    ASSERT_EQ(trained.exit_code, 0) << trained.err;
  }
  static void TearDownTestSuite() { delete directory_; }

  static RunResult predict(std::vector<std::string> more) {
    std::vector<std::string> arguments{"predict", store_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_engram(arguments);
  }

  static inline ScratchDirectory* directory_ = nullptr;
  static inline std::string store_;
};

TEST_F(Predict, TellsTheErrorToExpectAndABound) {
  const RunResult shown = predict({kCamera});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  for (const char* text :
       {"90 % bound", "200ms", "600ms", "2022-02-18 13:00:26.400000", "image by "})
    EXPECT_THAT(shown.out, HasSubstr(text));
  const Json answer = json_of(predict({kCamera, "--json"}));
  EXPECT_THAT(shown.out, HasSubstr("predicted by " + answer.at("engine").get<std::string>()));
  EXPECT_EQ(answer.at("from"), "2022-02-18 13:00:25.800000");
  ASSERT_EQ(answer.at("predictions").size(), 3u);
  for (const Json& one : answer.at("predictions")) {
    EXPECT_EQ(one.at("error_bound").at("probability"), 0.9);
    EXPECT_FALSE(one.contains("actual")) << "that is yet to come";
    EXPECT_FALSE(one.contains("error"));
    EXPECT_EQ(one.at("predicted").at("source"), "predicted");
  }
  const Json& next = answer.at("predictions").at(0);
  EXPECT_LE(next.at("error_bound").at("psnr_db").get<double>(),
            next.at("expected_error").at("psnr_db").get<double>());
  // A query answers with the same.
  const Json queried = json_of(run_engram({"query", store_, kCamera + " @ +200ms", "--json"}));
  const Json& instance = queried.at("entities").at(0).at("snapshots").at(0).at("instances").at(0);
  EXPECT_EQ(instance.at("error_bound"), next.at("error_bound"));
  EXPECT_EQ(instance.at("expected_error"), next.at("expected_error"));
  EXPECT_THAT(run_engram({"query", store_, kCamera + " @ +200ms"}).out, HasSubstr("dB, 90 %: "));
}

TEST_F(Predict, ComparesWithWhatCame) {
  const std::string picture = directory_->path() / "predict.png";
  const RunResult shown = predict({kCamera, "--compare", "--picture", picture});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("from 2022-02-18 13:00:25.200000"));
  std::ifstream png(picture, std::ios::binary);
  std::string signature(4, '\0');
  ASSERT_TRUE(png.read(signature.data(), 4));
  EXPECT_EQ(signature, "\x89PNG");
  const Json answer = json_of(predict({kCamera, "--at", "2022-02-18 13:00:10", "--horizons",
                                       "+200ms,+400ms", "--engine", "deep", "--json"}));
  // A model of so short a training may choose to copy: then its answer says so, in all members.
  const std::string engine = answer.at("engine");
  EXPECT_THAT(engine, AnyOf("deep", "copy-last"));
  const Json& image =
      answer.at("predictions").at(0).at("predicted").at("instances").at(0).at("members").at(0);
  EXPECT_EQ(image.at("engine"), engine);
  EXPECT_EQ(image.at("copied") == 1.0, engine == "copy-last");
  EXPECT_EQ(answer.at("model"), kCamera + " v1");
  ASSERT_EQ(answer.at("predictions").size(), 2u);
  const Json& far = answer.at("predictions").at(1);
  EXPECT_EQ(far.at("horizon_s"), 0.4);
  EXPECT_EQ(far.at("actual").at("id"), kCamera + "/2022-02-18 13:00:10.400000");
  EXPECT_EQ(far.at("actual").at("source"), "recorded");
  const double real = far.at("error").at("psnr_db").get<double>();
  EXPECT_EQ(far.at("within").get<bool>(),
            real >= far.at("error_bound").at("psnr_db").get<double>());
  EXPECT_GT(far.at("copy_last").at("error").at("psnr_db").get<double>(), 10);
  EXPECT_TRUE(far.at("copy_last").at("error_bound").contains("psnr_db"));
  // A copy of the last one is as wrong as it says of itself.
  const Json copied = json_of(predict({kCamera, "--at", "2022-02-18 13:00:10", "--horizons", "2",
                                       "--engine", "copy-last", "--json"}));
  EXPECT_EQ(copied.at("predictions").at(0).at("error"), far.at("copy_last").at("error"));
  EXPECT_EQ(copied.at("predictions").at(0).at("error_bound"),
            far.at("copy_last").at("error_bound"));
}

TEST_F(Predict, PredictsNumbers) {
  const RunResult shown = predict({kJoints, "--compare", "--horizons", "1..2"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("RMSE "));
  const Json answer = json_of(predict({kJoints, "--compare", "--horizons", "1", "--json"}));
  const Json& next = answer.at("predictions").at(0);
  EXPECT_TRUE(next.at("error").contains("rmse"));
  EXPECT_FALSE(next.at("error").contains("psnr_db"));
  EXPECT_TRUE(next.at("error_bound").contains("rmse"));
  const RunResult drawn = predict({kJoints, "--picture", directory_->path() / "none.png"});
  EXPECT_EQ(drawn.exit_code, 1);
  EXPECT_THAT(drawn.err, HasSubstr("image"));
}

TEST_F(Predict, SavesWhatItPredicts) {
  const std::string folder = directory_->path() / "future";
  const RunResult saved = predict({kCamera, "--save", folder, "--horizons", "1"});
  ASSERT_EQ(saved.exit_code, 0) << saved.err;
  EXPECT_THAT(saved.out, HasSubstr("2 files written below"));
  std::ifstream text(folder + "/" + kCamera + "/2022-02-18T13-00-26.000000.json");
  const Json data = Json::parse(text);
  EXPECT_EQ(data.at("source"), "predicted");
  EXPECT_TRUE(data.at("instances").at(0).contains("error_bound"));
}

TEST_F(Predict, ListsWhatCanPredict) {
  const RunResult shown = predict({kCamera, "--list"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  for (const char* text : {"deep v1", "copy-last", "steps of 200ms", "90 % bound", "answers",
                           "known", "unknown", "1s", "measured when it was trained"})
    EXPECT_THAT(shown.out, HasSubstr(text));
  const Json list = json_of(predict({kCamera, "--list", "--horizons", "200ms,1s", "--json"}));
  ASSERT_EQ(list.at("horizons").size(), 2u);
  for (const Json& horizon : list.at("horizons")) {
    const Json& engines = horizon.at("engines");
    ASSERT_EQ(engines.size(), 2u) << "no numbers to continue";
    EXPECT_EQ(engines.at(0).at("engine"), horizon.at("answers"));
    EXPECT_GE(engines.at(0).at("mean_error").at("psnr_db").get<double>(),
              engines.at(1).at("mean_error").at("psnr_db").get<double>());
    EXPECT_EQ(engines.at(0).at("measured_predictions"), engines.at(1).at("measured_predictions"))
        << "on the same moments";
  }
  const Json& models = list.at("models");
  ASSERT_EQ(models.size(), 4u);
  EXPECT_EQ(models.at(0).at("condition"), kJoints);
  EXPECT_EQ(models.at(0).at("is_condition_planned"), false);
  EXPECT_EQ(models.at(1).at("is_condition_planned"), true);
  EXPECT_EQ(models.at(2).at("is_condition_known"), false);
  EXPECT_EQ(models.at(3).at("engine"), "copy-last");
  ASSERT_EQ(models.at(3).at("horizons").size(), 5u);
  EXPECT_EQ(models.at(0).at("horizons").at(0).at("measured_predictions"), 10);
  EXPECT_EQ(models.at(1).at("horizons").at(0).at("measured_predictions"), 10);
  EXPECT_EQ(models.at(3).at("horizons").at(0).at("measured_predictions"), 64);
  EXPECT_GT(models.at(3).at("horizons").at(0).at("mean_error").at("psnr_db").get<double>(), 10);
}

TEST_F(Predict, AnswersWithTheBestEngineOfNumbers) {
  const Json list = json_of(predict({kJoints, "--list", "--horizons", "1..2", "--json"}));
  const Json answer = json_of(predict({kJoints, "--horizons", "1..2", "--json"}));
  ASSERT_EQ(list.at("horizons").size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    const Json& horizon = list.at("horizons").at(i);
    ASSERT_GE(horizon.at("engines").size(), 6u) << "the model and those of numbers";
    double before = 0;
    for (const Json& engine : horizon.at("engines")) {
      EXPECT_GE(engine.at("mean_error").at("rmse").get<double>(), before);
      before = engine.at("mean_error").at("rmse").get<double>();
    }
    std::set<std::string> engines, used;
    for (const Json& engine : horizon.at("engines")) engines.insert(engine.at("engine"));
    const Json& prediction = answer.at("predictions").at(i);
    for (const Json& member : prediction.at("predicted").at("instances").at(0).at("members")) {
      used.insert(member.at("engine"));
      EXPECT_TRUE(engines.contains(member.at("engine"))) << member;
    }
    EXPECT_EQ(prediction.at("engine"), used.size() == 1 ? *used.begin() : "mixed");
  }
  const Json named =
      json_of(predict({kJoints, "--horizons", "+300ms", "--engine", "line", "--json"}));
  EXPECT_EQ(named.at("engine"), "line");
  EXPECT_EQ(named.at("predictions").at(0).at("predicted").at("predictor"), "line");
  EXPECT_TRUE(named.at("predictions").at(0).at("expected_error").contains("rmse"));
  EXPECT_THAT(
      run_engram({"query", store_, kJoints + " @ +200ms"}).out,
      HasSubstr("(" + answer.at("predictions").at(0).at("engine").get<std::string>() + ")"));
}

TEST_F(Predict, FollowsAPlanAndSaysSo) {
  const std::vector<std::string> asked{kCamera, "--at", "2022-02-18 13:00:20", "--plan", kJoints};
  const RunResult shown = predict(asked);
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("predicted by deep v1, told the plan " + kJoints));
  std::vector<std::string> as_json = asked;
  as_json.emplace_back("--json");
  for (const Json& one : json_of(predict(as_json)).at("predictions")) {
    EXPECT_EQ(one.at("predicted").at("plan"), kJoints);
    const Json& members = one.at("predicted").at("instances").at(0).at("members");
    EXPECT_EQ(members.at(0).at("engine"), one.at("engine"));
    EXPECT_EQ(members.at(0).at("expected_error"), one.at("expected_error"));
  }
  const Json untold = json_of(predict({kCamera, "--at", "2022-02-18 13:00:20", "--json"}));
  EXPECT_FALSE(untold.at("predictions").at(0).at("predicted").contains("plan"));
  // After the newest moment nothing is planned; joints start from nothing that could be.
  const RunResult unplanned = predict({kCamera, "--plan", kJoints});
  EXPECT_EQ(unplanned.exit_code, 1);
  EXPECT_THAT(unplanned.err, HasSubstr("nothing is planned after"));
  EXPECT_EQ(predict({kJoints, "--plan", kJoints}).exit_code, 1);
  EXPECT_EQ(predict({kCamera, "--at", "2022-02-18 13:00:20", "--plan", kCamera}).exit_code, 1)
      << "of another layout";
  EXPECT_EQ(predict({kCamera, "--plan", "RobotState"}).exit_code, 2);
}

TEST_F(Predict, SweepsOverManyMoments) {
  const RunResult shown = predict({kCamera, "--every", "20", "--horizons", "1..2"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("within 90 % bound"));
  const Json all = json_of(predict({kCamera, "--from", "2022-02-18 13:00:10", "--to",
                                    "2022-02-18 13:00:12", "--horizons", "1", "--json"}));
  const Json& next = all.at("horizons").at(0);
  EXPECT_EQ(next.at("horizon_s"), 0.2);
  EXPECT_EQ(next.at("model").at("images"), 11);
  EXPECT_EQ(next.at("model_bound").at("images").at("predictions"), 11);
  EXPECT_LE(next.at("model_bound").at("images").at("within").get<int>(), 11);
}

TEST_F(Predict, CoverageIsEvaluated) {
  const RunResult shown = run_engram({"eval", store_, "--entity", "Vision"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  for (const char* text : {"90 % bound", "within", "mean bound", "as the prior told in training"})
    EXPECT_THAT(shown.out, HasSubstr(text));
  const Json entity =
      json_of(run_engram({"eval", store_, "--entity", "Vision", "--json"})).at("entities").at(0);
  const Json& held_out = entity.at("prediction").at("held out").at(0);
  EXPECT_EQ(held_out.at("model_bound").at("images").at("predictions"), 20);
  // Ten of the twenty calibrated the bound: at most one of them is beyond it.
  EXPECT_GE(held_out.at("model_bound").at("images").at("within").get<int>(), 9);
  EXPECT_EQ(held_out.at("copy_last_bound").at("images").at("predictions"), 20);
  EXPECT_GT(entity.at("code").at("prior_row_bytes").get<double>(), 0);
}

TEST_F(Predict, RefusesWhatItCannotDo) {
  for (const char* horizons : {"0", "3..1", "soon", "-1", "+0ms", "1,,2", "1..100000", ""}) {
    const RunResult refused = predict({kCamera, std::string("--horizons=") + horizons});
    EXPECT_EQ(refused.exit_code, 2) << horizons;
  }
  const RunResult far = predict({kCamera, "--horizons", "+61s"});
  EXPECT_EQ(far.exit_code, 1);
  EXPECT_THAT(far.err, HasSubstr("needs at most 1min"));
  EXPECT_EQ(predict({kCamera, "--engine", "oracle"}).exit_code, 1);
  EXPECT_THAT(predict({kCamera, "--engine", "oracle"}).err, HasSubstr("'oracle' predicts it"));
  EXPECT_THAT(predict({kCamera, "--engine", "oracle"}).err, HasSubstr("deep"));
  EXPECT_EQ(predict({kCamera, "--list", "--horizons", "soon"}).exit_code, 2);
  const RunResult old = predict({kCamera, "--list", "--ahead", "1"});
  EXPECT_EQ(old.exit_code, 0) << old.err;
  EXPECT_THAT(old.err, HasSubstr("'--ahead' is '--horizons' now"));
  EXPECT_EQ(predict({kCamera, "--at", "2001-01-01 00:00:00"}).exit_code, 1);
  EXPECT_EQ(predict({kCamera, "--compare", "--at", "2022-02-18 13:00:25.8"}).exit_code, 1);
  EXPECT_EQ(predict({kCamera, "--every", "5", "--compare"}).exit_code, 2);
  EXPECT_EQ(predict({kCamera, "--every", "0"}).exit_code, 2);
  EXPECT_EQ(predict({"Vision/RGB/head/none"}).exit_code, 1);
  EXPECT_EQ(predict({"Vision"}).exit_code, 2);
}

TEST(PredictWithoutModels, MeasuresWhatIsCopiedAndContinuesNumbers) {
  const ScratchDirectory directory;
  const std::string store = directory.path() / "robot.engram";
  ASSERT_EQ(run_engram(import_arguments(make_recording(directory.path(), 4), store)).exit_code, 0);
  const Json answer =
      json_of(run_engram({"predict", store, kCamera, "--compare", "--horizons", "1", "--json"}));
  EXPECT_EQ(answer.at("engine"), "copy-last");
  const Json& next = answer.at("predictions").at(0);
  EXPECT_TRUE(next.at("error_bound").contains("psnr_db"));
  EXPECT_TRUE(next.contains("within"));
  EXPECT_EQ(next.at("error"), next.at("copy_last").at("error"));
  const RunResult listed = run_engram({"predict", store, kJoints, "--list", "--horizons", "1..2"});
  ASSERT_EQ(listed.exit_code, 0) << listed.err;
  for (const char* text : {"copy-last", "line", "damped-line", "autoregression", "answers", "RMSE"})
    EXPECT_THAT(listed.out, HasSubstr(text));
  EXPECT_THAT(listed.out, testing::Not(HasSubstr("as its model tells")));
}

}  // namespace
}  // namespace engram::cli
