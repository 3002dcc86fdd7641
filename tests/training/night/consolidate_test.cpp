// SPDX-License-Identifier: Apache-2.0
#include "training/night/consolidate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "encoders/load_model.h"
#include "encoders/model_file.h"
#include "ltm/recall/recall.h"
#include "ltm/recording/recorder.h"
#include "ltm/store/night_records.h"
#include "tests/training/recorded_scene.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::quick_consolidation;
using engram::testing::quick_options;
using engram::testing::record;
using engram::testing::ScratchPath;

/// Least PSNR over all snapshots, from what a query answers. Unit: dB.
double lowest_psnr_db(const std::filesystem::path& store) {
  ltm::Recall recall(*ltm::StoreReader::open(store), encoders::load_model);
  ltm::Recall::Options prefer_latent;
  prefer_latent.prefer = ltm::Recall::Prefer::kLatent;
  const auto answer = recall.query(*ltm::Query::parse("Test @ all"), prefer_latent);
  double lowest = kLargestPsnrDb;
  int i = 0;
  for (const auto& snapshot : answer->entities()[0]->snapshots) {
    const auto error = compare(engram::testing::scene_at(i++), snapshot.instances[0].data);
    lowest = std::min(lowest, psnr_db(error->image_mse));
  }
  return lowest;
}

TEST(Consolidate, PublishesLatentsThatAQueryDecodes) {
  const ScratchPath store("consolidate");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  const auto report = consolidate(store.path(), quick_consolidation(), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  ASSERT_EQ(report->entities.size(), 1u);
  const EntityReport& entity = report->entities[0];
  EXPECT_EQ(entity.skipped_reason, "");
  EXPECT_EQ(entity.snapshots, 20u);
  EXPECT_EQ(entity.model_version, 1);
  EXPECT_LT(entity.latent_bytes, entity.raw_bytes);
  EXPECT_GT(entity.model_bytes, 0u);

  ltm::Recall recall(*ltm::StoreReader::open(store.path()), encoders::load_model);
  ltm::Recall::Options prefer_latent;
  prefer_latent.prefer = ltm::Recall::Prefer::kLatent;
  const auto answer = recall.query(*ltm::Query::parse("Test @ all"), prefer_latent);
  ASSERT_TRUE(answer.ok()) << answer.status().to_string();
  const auto& snapshots = answer->entities()[0]->snapshots;
  ASSERT_EQ(snapshots.size(), 20u);
  EXPECT_EQ(snapshots[5].source, ltm::Source::kReconstructed);
  const auto error = compare(engram::testing::scene_at(5), snapshots[5].instances[0].data);
  EXPECT_DOUBLE_EQ(error->image_mse, snapshots[5].instances[0].error->image_mse);
}

TEST(Consolidate, WritesDownWhatItDid) {
  const ScratchPath store("written-down");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  record(store.path(), "Test/Scene/sim/few", 0, 3);
  const auto report = consolidate(store.path(), quick_consolidation(), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  auto found = ltm::read_nights(store.path(), 9);
  ASSERT_TRUE(found.ok()) << found.status().to_string();
  ASSERT_EQ(found->nights.size(), 1u);
  const ltm::NightRecord night = found->nights[0];
  EXPECT_EQ(night.work, ltm::NightWork::kConsolidate);
  EXPECT_EQ(night.began, report->began);
  EXPECT_EQ(night.failure, "");
  // Of the other entity there is too little, as its plan said.
  ASSERT_EQ(night.entities.size(), 1u);
  const ltm::NightEntity& entity = night.entities[0];
  EXPECT_EQ(entity.entity, id("Test/Scene/sim/square"));
  EXPECT_EQ(entity.encoded, 20u);
  EXPECT_EQ(entity.learned, report->entities[1].training.used_snapshots);
  EXPECT_EQ(entity.models_added, std::vector{1});
  EXPECT_NEAR(*entity.psnr_db, report->entities[1].mean_psnr_db, 0.006);
  EXPECT_NEAR(*entity.min_psnr_db, report->entities[1].minimum_psnr_db, 0.006);
  const auto summary = (*ltm::StoreReader::open(store.path()))->summary(entity.entity);
  EXPECT_EQ(entity.bytes_after - entity.bytes_before, summary->latent_bytes + summary->model_bytes);

  // A night that is stopped says so, and one with nothing to do says that.
  record(store.path(), "Test/Scene/sim/square", 20, 20);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(consolidate(store.path(), quick_consolidation(), {}, stop.get_token()).status().code(),
            StatusCode::kCancelled);
  ASSERT_TRUE(consolidate(store.path(), quick_consolidation(), {}, {}).ok());
  ASSERT_TRUE(consolidate(store.path(), quick_consolidation(), {}, {}).ok());
  found = ltm::read_nights(store.path(), 9);
  EXPECT_TRUE(found->nights.at(0).entities.empty());
  EXPECT_EQ(found->nights.at(1).entities.at(0).entity, id("Test/Scene/sim/square"));
}

TEST(Consolidate, KeepsEveryImageWithinTheBound) {
  for (const double bound_db : {30.0, 42.0}) {
    for (const Representation kind :
         {Representation::kAuto, Representation::kVideo, Representation::kCorrected}) {
      const ScratchPath store("bound");
      record(store.path(), "Test/Scene/sim/square", 0, 40);
      auto chosen = quick_consolidation();
      chosen.representation.kind = kind;
      chosen.representation.bound_db = bound_db;
      chosen.representation.video_effort = 1;
      chosen.representation.nights = 100000;  // Networks are worth trying.
      const auto report = consolidate(store.path(), chosen, {}, {});
      ASSERT_TRUE(report.ok()) << report.status().to_string();
      const auto& forms = report->entities[0].forms;
      EXPECT_EQ(forms.rows, 40);
      EXPECT_EQ(forms.latent_rows + forms.refined_rows + forms.residual_rows + forms.video_rows +
                    forms.lossless_rows,
                40);
      if (kind == Representation::kCorrected) {
        EXPECT_EQ(forms.video_rows + forms.lossless_rows, 0);
        EXPECT_LE(forms.kept_bytes, forms.residual_bytes);
      } else {
        EXPECT_LE(forms.kept_bytes, forms.video_bytes);
        // Where it cannot win it is not tried.
        if (forms.lossless_bytes > 0) {
          EXPECT_LE(forms.kept_bytes, forms.lossless_bytes);
        }
      }
      EXPECT_EQ(forms.noise_images, 0);
      const EntityReport& one = report->entities[0];
      EXPECT_GE(one.minimum_psnr_db, bound_db);
      EXPECT_LE(one.minimum_psnr_db, one.psnr_quantiles_db[0]);
      EXPECT_LE(one.psnr_quantiles_db[0], one.psnr_quantiles_db[1]);
      EXPECT_LE(one.psnr_quantiles_db[1], one.psnr_quantiles_db[2]);
      EXPECT_GE(lowest_psnr_db(store.path()), bound_db) << to_string(kind);
    }
  }
}

TEST(Consolidate, MixesLatentsAndVideoWhereEachIsBetter) {
  const ScratchPath store("mixed");
  record(store.path(), "Test/Scene/sim/square", 0, 40);
  auto chosen = quick_consolidation();
  chosen.train = quick_options(600);
  chosen.representation.kind = Representation::kAuto;
  chosen.representation.bound_db = 24;
  chosen.representation.video_effort = 1;
  chosen.representation.nights = 100000;
  const auto report = consolidate(store.path(), chosen, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const auto& forms = report->entities[0].forms;
  EXPECT_GT(forms.latent_rows, 0);
  EXPECT_LT(forms.kept_bytes, forms.video_bytes);
  EXPECT_GE(lowest_psnr_db(store.path()), 24);
  const auto provenance = encoders::read_provenance(
      store.path() / ltm::read_manifest(store.path())->models.front().file);
  ASSERT_TRUE(provenance.ok()) << provenance.status().to_string();
  EXPECT_EQ(provenance->forms, forms);
}

/// `count` snapshots of a still, shaded image as a camera sees it whose noise has a deviation of 4.
void record_noise(const std::filesystem::path& store, int count) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 4);
  auto recorder = ltm::Recorder::open(store, {});
  ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
  for (int i = 0; i < count; ++i) {
    std::vector<uint8_t> pixels;
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 3 * 64; ++x)
        pixels.push_back(static_cast<uint8_t>(std::lround(60 + y + 0.5 * x + noise(random))));
    idf::Dict dict;
    dict.set("image", idf::NdArray::take<uint8_t>({48, 64, 3}, std::move(pixels)));
    const ltm::Snapshot snapshot{
        id("Test/Noise/sim/camera"), Time(std::chrono::milliseconds(200 * i)), {{dict, {}}}};
    ASSERT_TRUE(recorder->commit({{snapshot}}).ok());
  }
  ASSERT_TRUE(recorder->close().ok());
}

TEST(Consolidate, TakesTheBoundFromTheNoiseOfTheImages) {
  const ScratchPath store("noise");
  record_noise(store.path(), 20);
  auto chosen = quick_consolidation();
  chosen.representation.kind = Representation::kVideo;
  chosen.representation.video_effort = 1;
  ConsolidatePlan plan;
  const auto report =
      consolidate(store.path(), chosen, {}, {}, [&](const ConsolidatePlan& made) { plan = made; });
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const ImageBound& bound = plan.entities[0].bound;
  EXPECT_NEAR(bound.noise, 4, 0.25);
  EXPECT_NEAR(bound.bound_db, 36.1, 0.5);
  EXPECT_EQ(bound.noise_images, 19);
  const EntityReport& entity = report->entities[0];
  EXPECT_EQ(entity.forms.bound_db, bound.bound_db);
  EXPECT_EQ(entity.forms.noise_images, 19);
  EXPECT_GE(entity.minimum_psnr_db, bound.bound_db);
  const auto provenance = encoders::read_provenance(
      store.path() / ltm::read_manifest(store.path())->models.front().file);
  ASSERT_TRUE(provenance.ok()) << provenance.status().to_string();
  EXPECT_EQ(provenance->forms, entity.forms);
}

TEST(Consolidate, TrainsNoNetworksThatCannotPay) {
  const ScratchPath store("video_only");
  record(store.path(), "Test/Scene/sim/square", 0, 40);
  auto chosen = quick_consolidation();
  chosen.representation.kind = Representation::kAuto;
  chosen.representation.nights = 1;
  const auto report = consolidate(store.path(), chosen, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->entities[0].forms.latent_rows, 0);
  EXPECT_EQ(report->entities[0].training.autoencoder_steps, 0);
  ASSERT_EQ(report->entities[0].notes.size(), 1u);
  auto model =
      encoders::load_model(store.path() / ltm::read_manifest(store.path())->models.front().file);
  ASSERT_TRUE(model.ok()) << model.status().to_string();
  const std::vector<idf::Data> history{engram::testing::scene_at(3), engram::testing::scene_at(4)};
  const auto predicted = model->predictor->predict(history, 2);
  ASSERT_TRUE(predicted.ok()) << predicted.status().to_string();
  EXPECT_EQ(compare(predicted->back().value, history.back())->image_mse, 0.0);
}

TEST(Consolidate, LearnsToPredictFromTheNumbersThatImagesLinkTo) {
  const ScratchPath store("condition");
  const ltm::MemoryId camera = id("Test/Scene/sim/camera"), joints = id("Test/Robot/sim/joints");
  {
    auto recorder = ltm::Recorder::open(store.path(), {});
    ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
    const auto source = engram::testing::scene_source(30);
    for (int i = 0; i < 30; ++i) {
      const Time time = source.times[static_cast<size_t>(i)];
      idf::Data image = engram::testing::scene_at(i, true, false);
      image.get_if<idf::Dict>()->set("state", joints.at(time).to_string());
      const idf::Data state = engram::testing::scene_at(i, false, true);
      ASSERT_TRUE(
          recorder->commit({{{camera, time, {{image, {}}}}, {joints, time, {{state, {}}}}}}).ok());
    }
    ASSERT_TRUE(recorder->close().ok());
  }
  ASSERT_TRUE(consolidate(store.path(), quick_consolidation(), {}, {}).ok());
  const ltm::Manifest manifest = *ltm::read_manifest(store.path());
  for (const ltm::MemoryId& entity : {camera, joints}) {
    auto model = encoders::load_model(store.path() / manifest.newest_model(entity)->file);
    ASSERT_TRUE(model.ok()) << model.status().to_string();
    const auto condition = model->predictor->condition();
    // Numbers have no motion that could be told of others.
    EXPECT_EQ(condition.has_value(), entity == camera);
    if (condition) {
      EXPECT_EQ(*condition, joints);
    }
  }
  ltm::Recall recall(*ltm::StoreReader::open(store.path()), encoders::load_model);
  const auto answer = recall.query(*ltm::Query::parse("Test/Scene @ +200ms"));
  ASSERT_TRUE(answer.ok()) << answer.status().to_string();
  EXPECT_EQ(answer->entities()[0]->snapshots[0].predictor, "deep");
}

TEST(Consolidate, SkipsWhatHasNothingNewUnlessForced) {
  const ScratchPath store("nothing_new");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  ASSERT_TRUE(consolidate(store.path(), quick_consolidation(), {}, {}).ok());
  EXPECT_EQ(consolidate(store.path(), quick_consolidation(), {}, {})->entities[0].skipped_reason,
            "nothing new");
  record(store.path(), "Test/Scene/sim/square", 20, 4);
  EXPECT_EQ(consolidate(store.path(), quick_consolidation(), {}, {})->entities[0].model_version, 2);
  auto forced = quick_consolidation();
  forced.force = true;
  EXPECT_EQ(consolidate(store.path(), forced, {}, {})->entities[0].model_version, 3);
}

TEST(Consolidate, PlansBeforeItTrains) {
  const ScratchPath store("plan");
  record(store.path(), "Test/Scene/sim/large", 0, 20);
  record(store.path(), "Test/Scene/sim/small", 0, 3);
  auto chosen = quick_consolidation();
  const auto before = ltm::read_manifest(store.path())->generation;
  auto plan = plan_consolidation(store.path(), chosen, {});
  ASSERT_TRUE(plan.ok()) << plan.status().to_string();
  EXPECT_EQ(ltm::read_manifest(store.path())->generation, before);
  ASSERT_EQ(plan->entities.size(), 2u);
  EXPECT_EQ(plan->entities[1].skipped_reason, "3 recorded snapshots, needs 16");
  EXPECT_EQ(plan->entities[1].budget_share, 0.0);
  const EntityPlan first = plan->entities[0];
  EXPECT_EQ(first.snapshots, 20u);
  EXPECT_EQ(first.new_snapshots, 20u);
  EXPECT_GE(first.plain_bytes, 20u * 40 * 48 * 3);
  EXPECT_GT(first.stored_bytes, 0u);
  EXPECT_EQ(first.budget_share, 1.0);
  EXPECT_EQ(first.expected_gain_bytes(), std::nullopt);

  std::vector<EntityPlan> told;
  const auto report = consolidate(store.path(), chosen, {}, {}, [&](const ConsolidatePlan& made) {
    EXPECT_EQ(ltm::read_manifest(store.path())->generation, before);
    told = made.entities;
  });
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].snapshots, report->entities[0].snapshots);
  EXPECT_EQ(told[0].plain_bytes, report->entities[0].raw_bytes);

  record(store.path(), "Test/Scene/sim/large", 20, 4);
  plan = plan_consolidation(store.path(), chosen, {});
  ASSERT_TRUE(plan.ok()) << plan.status().to_string();
  const EntityPlan& again = plan->entities[0];
  EXPECT_EQ(again.snapshots, 24u);
  EXPECT_EQ(again.new_snapshots, 4u);
  EXPECT_EQ(again.newest_version, 1);
  ASSERT_TRUE(again.latent_bytes_per_snapshot.has_value());
  EXPECT_GE(*again.latent_bytes_per_snapshot * 20,
            static_cast<double>(report->entities[0].latent_bytes));
  EXPECT_DOUBLE_EQ(*again.expected_gain_bytes(),
                   static_cast<double>(again.stored_bytes) - *again.expected_bytes());
}

TEST(Consolidate, KeepsTinyImagesWithinTheBoundOrLeavesThemRecorded) {
  const ScratchPath store("tiny_images");
  {
    auto recorder = ltm::Recorder::open(store.path(), {});
    ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
    for (int i = 0; i < 20; ++i) {
      idf::Dict dict;
      dict.set("image", idf::NdArray::take<uint8_t>(
                            {8, 8, 1}, std::vector<uint8_t>(64, static_cast<uint8_t>(i))));
      const Time time(std::chrono::milliseconds(200 * i));
      ASSERT_TRUE(recorder->commit({{{id("Test/Scene/sim/tiny"), time, {{dict, {}}}}}}).ok());
    }
    ASSERT_TRUE(recorder->close().ok());
  }
  for (const Representation kind : {Representation::kAuto, Representation::kVideo}) {
    auto chosen = quick_consolidation();
    chosen.representation.kind = kind;
    chosen.force = true;
    const auto report = consolidate(store.path(), chosen, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().to_string();
    const EntityReport& tiny = report->entities[0];
    EXPECT_TRUE(!tiny.skipped_reason.empty() || tiny.minimum_psnr_db >= 36) << tiny.minimum_psnr_db;
  }
}

TEST(Consolidate, TakesNumbersAloneWithEveryRepresentation) {
  for (const Representation kind : {Representation::kAuto, Representation::kCorrected}) {
    const ScratchPath store("numbers_alone");
    {
      auto recorder = ltm::Recorder::open(store.path(), {});
      ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
      for (int i = 0; i < 60; ++i) {
        const auto at = static_cast<float>(i);
        const idf::Dict joints{
            {"joints", idf::NdArray::take<float>({2}, {std::sin(0.1f * at), std::cos(0.1f * at)})}};
        const Time time(std::chrono::milliseconds(200 * i));
        ASSERT_TRUE(recorder->commit({{{id("Test/Joints/sim/arm"), time, {{joints, {}}}}}}).ok());
      }
      ASSERT_TRUE(recorder->close().ok());
    }
    auto chosen = quick_consolidation();
    chosen.representation.kind = kind;
    chosen.force = true;
    const auto report = consolidate(store.path(), chosen, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().to_string();
    EXPECT_EQ(report->entities[0].skipped_reason, "");
    EXPECT_EQ(report->entities[0].snapshots, 60u);
  }
}

TEST(Consolidate, SkipsSmallEntitiesAndTakesOnlyThoseAskedFor) {
  const ScratchPath store("filter");
  record(store.path(), "Test/Scene/sim/large", 0, 17);
  record(store.path(), "Test/Scene/sim/small", 0, 3);
  auto chosen = quick_consolidation();
  chosen.entities = {"Test/Scene/sim/small"};
  const auto report = consolidate(store.path(), chosen, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  ASSERT_EQ(report->entities.size(), 1u);
  EXPECT_EQ(report->entities[0].skipped_reason, "3 recorded snapshots, needs 16");
  chosen.entities = {"Nothing"};
  EXPECT_EQ(consolidate(store.path(), chosen, {}, {}).status().code(), StatusCode::kNotFound);
}

TEST(Consolidate, LeavesTheStoreAsItWasWhenStopped) {
  const ScratchPath store("stopped_job");
  record(store.path(), "Test/Scene/sim/square", 0, 20);
  std::stop_source stop;
  const ProgressSink sink = [&](const Progress& progress) {
    if (progress.what.starts_with("encode")) stop.request_stop();
  };
  const auto before = ltm::read_manifest(store.path())->generation;
  EXPECT_EQ(
      consolidate(store.path(), quick_consolidation(), sink, stop.get_token()).status().code(),
      StatusCode::kCancelled);
  EXPECT_EQ(ltm::read_manifest(store.path())->generation, before);
}

}  // namespace
}  // namespace engram::training
