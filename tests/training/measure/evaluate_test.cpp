// SPDX-License-Identifier: Apache-2.0
#include "training/measure/evaluate.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "encoders/model_file.h"
#include "ltm/recording/recorder.h"
#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "tests/training/moving_scene.h"
#include "training/night/consolidate.h"

namespace engram::training {
namespace {

using engram::testing::ScratchPath;

const char* const kEntity = "Test/Scene/sim/square";

void record(const TrainingSource& source, const std::filesystem::path& store) {
  auto recorder = ltm::Recorder::open(store, {});
  ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
  for (size_t i = 0; i < source.times.size(); ++i)
    ASSERT_TRUE(
        recorder
            ->commit({{{*ltm::MemoryId::parse(kEntity), source.times[i], {{*source.read(i), {}}}}}})
            .ok());
  ASSERT_TRUE(recorder->close().ok());
}

void record_and_consolidate(const std::filesystem::path& store) {
  record(engram::testing::scene_source(60, 3), store);
  ConsolidateOptions options;
  options.train = engram::testing::quick_options(20);
  options.train.hold_out_recordings = 1;
  const auto report = consolidate(store, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
}

TEST(Evaluate, KeepsWhatTheModelWasTrainedOnApart) {
  const ScratchPath store("evaluate");
  record_and_consolidate(store.path());
  const auto report = evaluate(store.path(), {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  ASSERT_EQ(report->entities.size(), 1u);
  const EntityEvaluation& entity = report->entities[0];
  // The whole chain is decoded with its first snapshot, which a median would leave out.
  EXPECT_GT(entity.access.in_order_ms, 0);
  EXPECT_GT(entity.access.scattered_ms, 0);
  EXPECT_GE(entity.access.scattered_p99_ms, entity.access.scattered_ms);
  EXPECT_EQ(entity.snapshots, 60u);
  EXPECT_EQ(entity.reconstruction.images, 40u);
  EXPECT_EQ(entity.left_out_reconstruction.images, 20u);
  // Of 20 snapshots 18 have one before and one after; the last 3 are held out from the dynamics.
  const auto counted = [&](Known known, size_t horizon) {
    return entity.prediction[static_cast<size_t>(known)][horizon].model.images;
  };
  EXPECT_EQ(counted(Known::kTrained, 0), 2 * 15u);
  EXPECT_EQ(counted(Known::kHeldOut, 0), 2 * 3u);
  EXPECT_EQ(counted(Known::kLeftOutRecording, 0), 18u);
  EXPECT_EQ(counted(Known::kLeftOutRecording, 1), 17u);
}

TEST(Evaluate, CountsNoNamedNumberInPredictions) {
  const ScratchPath store("evaluate_enum");
  const auto source = engram::testing::scene_source(60);
  {
    auto recorder = ltm::Recorder::open(store.path(), {});
    ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
    const idf::Type type = idf::Type::object(
        "Door", {{"x", idf::Type::float64()},
                 {"mode", idf::Type::int_enum("Mode", {{"open", 1}, {"closed", 7}})}});
    ASSERT_TRUE(recorder->declare(*ltm::MemoryId::parse("Test/Scene"), type).ok());
    for (size_t i = 0; i < source.times.size(); ++i) {
      const idf::Data value = idf::Dict{{"x", 0.5 * static_cast<double>(i)},
                                        {"mode", i % 2 == 0 ? int32_t{1} : int32_t{7}}};
      ASSERT_TRUE(
          recorder->commit({{{*ltm::MemoryId::parse(kEntity), source.times[i], {{value, {}}}}}})
              .ok());
    }
    ASSERT_TRUE(recorder->close().ok());
  }
  ConsolidateOptions options;
  options.train = engram::testing::quick_options(5);
  const auto consolidated = consolidate(store.path(), options, {}, {});
  ASSERT_TRUE(consolidated.ok()) << consolidated.status().to_string();
  const auto report = evaluate(store.path(), {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const auto& kinds = report->entities.at(0).prediction;
  const Quality& copied = kinds[static_cast<size_t>(Known::kTrained)].at(0).copy_last;
  ASSERT_GT(copied.numbers, 0u);
  EXPECT_NEAR(copied.rmse, 0.5, 1e-3) << "that of x; the door opens or closes at each step";
}

TEST(Evaluate, BytesOfLatentsAreWhatProbabilitiesSay) {
  const ScratchPath store("code_length");
  record(engram::testing::scene_source(64, 2, true, false), store.path());
  ConsolidateOptions options;
  options.train = engram::testing::quick_options(100);
  options.representation.kind = Representation::kLatents;
  options.access = Duration::zero();  // Chains of 16.
  ASSERT_TRUE(consolidate(store.path(), options, {}, {}).ok());
  const auto report = evaluate(store.path(), {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const CodeLength& code = report->entities.at(0).code;
  EXPECT_EQ(code.rows, 64u);
  EXPECT_EQ(code.later_rows, 60u) << "four blocks of 16";
  // Each block ends in four bytes of checksum and at most two that end the stream.
  EXPECT_GT(code.coded_bytes, 4 * 4 + 0.99 * code.ideal_bytes - 4);
  EXPECT_LT(code.coded_bytes, 4 * 6 + 1.01 * code.ideal_bytes);
  EXPECT_NEAR(code.coded_bytes, code.ideal_bytes, 0.03 * code.ideal_bytes);
  EXPECT_GT(code.later_bytes, 0);
  EXPECT_LT(code.later_bytes, code.ideal_bytes);
  const auto provenance = encoders::read_provenance(
      store.path() / ltm::read_manifest(store.path())->models.front().file);
  ASSERT_TRUE(provenance.ok()) << provenance.status().to_string();
  EXPECT_GT(code.prior_row_bytes, 0);
  EXPECT_EQ(code.prior_row_bytes, provenance->prior_bytes);
}

TEST(Evaluate, CountsHowOftenErrorsAreWithinTheirBounds) {
  const ScratchPath store("coverage");
  record(engram::testing::scene_source(180, 3), store.path());
  ConsolidateOptions options;
  options.train = engram::testing::quick_options(60);
  options.train.hold_out_recordings = 1;
  options.representation.kind = Representation::kLatents;
  ASSERT_TRUE(consolidate(store.path(), options, {}, {}).ok());
  const auto report = evaluate(store.path(), {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const auto& prediction = report->entities.at(0).prediction;
  const PredictionQuality& held_out = prediction[static_cast<size_t>(Known::kHeldOut)][0];
  // Two recordings of 60: nine each are held out, nine of all calibrated.
  EXPECT_EQ(held_out.model_bound_coverage.images.predictions, 18u);
  EXPECT_EQ(held_out.model_bound_coverage.numbers.predictions, 18u);
  // Of nine scores the bound is the largest one: all others are within.
  EXPECT_GE(held_out.model_bound_coverage.images.within, 8u);
  EXPECT_EQ(held_out.copy_bound_coverage.images.predictions, 18u);
  const PredictionQuality& left_out = prediction[static_cast<size_t>(Known::kLeftOutRecording)][0];
  EXPECT_EQ(left_out.copy_bound_coverage.images.predictions, 58u);
  // The square goes on as before: what was expected is about right, and bounds hold.
  EXPECT_GT(left_out.copy_bound_coverage.images.share(), 0.7);
  EXPECT_NEAR(left_out.copy_bound_coverage.images.expected, left_out.copy_last.pooled_psnr_db, 1.5);
  EXPECT_LE(left_out.copy_bound_coverage.images.mean_bound,
            left_out.copy_bound_coverage.images.expected);
  EXPECT_GE(left_out.copy_bound_coverage.numbers.mean_bound,
            left_out.copy_bound_coverage.numbers.expected);
  const auto json = to_json(left_out);
  EXPECT_EQ(json.at("copy_last_bound").at("probability"), 0.9);
  EXPECT_EQ(json.at("copy_last_bound").at("images").at("predictions"), 58);
  EXPECT_EQ(json.at("model_bound").at("numbers").at("share").get<double>(),
            left_out.model_bound_coverage.numbers.share());
}

TEST(Evaluate, CountsSnapshotsWithoutTruth) {
  const ScratchPath store("dropped");
  record_and_consolidate(store.path());
  ASSERT_TRUE(ltm::drop_recorded(store.path(), *ltm::MemoryId::parse(kEntity), {}).ok());
  const auto report = evaluate(store.path(), {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->entities[0].not_evaluated, 60u);
  EXPECT_EQ(report->entities[0].reconstruction.images, 0u);
}

TEST(Evaluate, BecomesJsonWithNullForWhatIsMissing) {
  EvalReport report;
  report.entities.push_back({});
  report.entities[0].entity = *ltm::MemoryId::parse(kEntity);
  report.entities[0].reconstruction.rmse = std::numeric_limits<double>::quiet_NaN();
  report.entities[0].prediction[0].push_back({1, {}, {}});
  const auto json = to_json(report);
  EXPECT_EQ(json["entities"][0]["entity"], kEntity);
  EXPECT_TRUE(json["entities"][0]["reconstruction"]["rmse"].is_null());
  const auto& prediction = json["entities"][0]["prediction"]["trained on"][0];
  EXPECT_EQ(prediction["horizon"], 1);
  EXPECT_TRUE(prediction["model_bound"]["images"]["share"].is_null());
}

}  // namespace
}  // namespace engram::training
