// SPDX-License-Identifier: Apache-2.0
// Nights that build on each other: `consolidate` again on a store that has models.
#include <gtest/gtest.h>

#include "encoders/load_model.h"
#include "encoders/model_file.h"
#include "ltm/core/file.h"
#include "ltm/recall/recall.h"
#include "ltm/store/store_check.h"
#include "ltm/store/store_reader.h"
#include "tests/training/recorded_scene.h"
#include "training/night/consolidate.h"
#include "training/night/drop_raw.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::kSquare;
using engram::testing::night;
using engram::testing::quick_consolidation;
using engram::testing::quick_options;
using engram::testing::record;
using engram::testing::scene_at;
using engram::testing::scene_source;
using engram::testing::ScratchPath;

constexpr double kBoundDb = 24;

/// A second room: the scene in other colours, an hour later.
Time later(int i) {
  return scene_source(i + 1).times.back() + std::chrono::hours(1);
}

idf::Data recoloured(int i) {
  idf::Data value = scene_at(i);
  const auto& image = value.at("image")->get<idf::NdArray>();
  std::vector<uint8_t> pixels;
  for (const uint8_t level : image.values<uint8_t>())
    pixels.push_back(static_cast<uint8_t>(255 - level));
  value.get_if<idf::Dict>()->set("image",
                                 idf::NdArray::take<uint8_t>(image.shape(), std::move(pixels)));
  return value;
}

void record_recoloured(const std::filesystem::path& store, int count) {
  auto recorder = ltm::Recorder::open(store, {});
  ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
  for (int i = 0; i < count; ++i)
    ASSERT_TRUE(recorder->commit({{{id(kSquare), later(i), {{recoloured(i), {}}}}}}).ok());
  ASSERT_TRUE(recorder->close().ok());
}

/// The automatic representation with networks that are worth trying, trained for some steps.
ConsolidateOptions automatic(int steps) {
  auto chosen = quick_consolidation();
  chosen.train = quick_options(steps);
  chosen.representation.kind = Representation::kAuto;
  chosen.representation.bound_db = kBoundDb;
  chosen.representation.video_effort = 1;
  chosen.representation.nights = 100000;
  return chosen;
}

/// Versions of the models of a store.
std::vector<int> versions(const std::filesystem::path& store) {
  std::vector<int> found;
  for (const ltm::ModelInfo& model : ltm::read_manifest(store)->models)
    found.push_back(model.version);
  return found;
}

void expect_clean(const std::filesystem::path& store) {
  const ltm::CheckOptions deep{.is_deep = true,
                               .test_model = [](const std::filesystem::path& file) -> Status {
                                 return encoders::load_model(file).status();
                               }};
  const auto checked = ltm::check_store(store, deep);
  ASSERT_TRUE(checked.ok()) << checked.status().to_string();
  EXPECT_TRUE(checked->is_clean()) << checked->findings.front().what;
}

/// Least PSNR of all snapshots as latents. Unit: dB.
double lowest_psnr_db(const std::filesystem::path& store, size_t snapshots) {
  ltm::Recall recall(*ltm::StoreReader::open(store), encoders::load_model);
  const auto answer =
      recall.query(*ltm::Query::parse("Test @ all"), {.prefer = ltm::Recall::Prefer::kLatent});
  EXPECT_TRUE(answer.ok()) << answer.status().to_string();
  double lowest = kLargestPsnrDb;
  const auto& found = answer->entities()[0]->snapshots;
  EXPECT_EQ(found.size(), snapshots);
  for (size_t i = 0; i < found.size(); ++i) {
    const bool is_later = found[i].time >= later(0);
    const auto at = static_cast<int>(i);
    const int index =
        is_later ? static_cast<int>((found[i].time - later(0)) / std::chrono::milliseconds(200))
                 : at;
    const auto error =
        compare(is_later ? recoloured(index) : scene_at(index), found[i].instances[0].data);
    lowest = std::min(lowest, psnr_db(error->image_mse));
  }
  return lowest;
}

TEST(LaterNight, StartsFromTheNewestModelUnlessTold) {
  const ScratchPath store("later_start");
  record(store.path(), kSquare, 0, 20);
  EXPECT_EQ(night(store.path(), quick_consolidation()).training.started_from, 0);
  record(store.path(), kSquare, 20, 4);
  EXPECT_EQ(night(store.path(), quick_consolidation()).training.started_from, 1);
  auto chosen = quick_consolidation();
  chosen.force = true;
  chosen.starts_anew = true;
  EXPECT_EQ(night(store.path(), chosen).training.started_from, 0);
  EXPECT_EQ(versions(store.path()), std::vector<int>{3});
}

TEST(LaterNight, PublishesANewModelOnlyWhereTheDataChanged) {
  const ScratchPath store("later_nights");
  record(store.path(), kSquare, 0, 40);
  const EntityReport first = night(store.path(), automatic(600));
  EXPECT_TRUE(first.is_model_new);
  EXPECT_EQ(first.choice.previous_version, 0);
  EXPECT_GT(first.forms.latent_rows, 0);
  const auto drop = [&] {
    return drop_raw(store.path(), id(kSquare), {.min_psnr_db = kBoundDb, .max_rmse = 1}, {}, {});
  };
  ASSERT_TRUE(drop().ok());

  // More of the same.
  const auto before = *ltm::read_manifest(store.path());
  record(store.path(), kSquare, 40, 20);
  auto chosen = automatic(30);
  chosen.representation.nights = 2;
  const EntityReport same = night(store.path(), chosen);
  EXPECT_FALSE(same.is_model_new);
  EXPECT_EQ(same.model_version, 1);
  EXPECT_EQ(same.snapshots, 20u);
  EXPECT_EQ(same.choice.previous_version, 1);
  EXPECT_EQ(same.choice.snapshots, 20);
  EXPECT_EQ(same.choice.new_snapshots, 20);
  EXPECT_EQ(same.choice.previous.model, 0) << "latents without a recorded form keep it";
  EXPECT_GT(same.choice.made.model, 0);
  EXPECT_EQ(same.choice.previous.news, static_cast<int64_t>(same.latent_bytes));
  EXPECT_TRUE(same.choice.keeps_previous());
  EXPECT_GE(same.minimum_psnr_db, kBoundDb);
  const auto after = *ltm::read_manifest(store.path());
  ASSERT_EQ(after.models.size(), 1u);
  EXPECT_EQ(after.models[0].checksum, before.models[0].checksum);
  EXPECT_GE(lowest_psnr_db(store.path(), 60), kBoundDb);
  EXPECT_EQ(consolidate(store.path(), chosen, {}, {})->entities[0].skipped_reason, "nothing new");
  expect_clean(store.path());

  // Another room.
  record_recoloured(store.path(), 40);
  const EntityReport other = night(store.path(), automatic(600));
  EXPECT_TRUE(other.is_model_new);
  EXPECT_EQ(other.model_version, 2);
  EXPECT_EQ(other.training.started_from, 1);
  EXPECT_EQ(other.snapshots, 60u);
  EXPECT_EQ(other.choice.previous_version, 1);
  EXPECT_EQ(other.choice.new_snapshots, 40);
  EXPECT_LT(other.choice.made.news, other.choice.previous.news);
  EXPECT_FALSE(other.choice.keeps_previous());
  EXPECT_EQ(versions(store.path()), (std::vector<int>{1, 2}));
  EXPECT_GE(lowest_psnr_db(store.path(), 100), kBoundDb);
  const auto provenance = encoders::read_provenance(
      store.path() / ltm::read_manifest(store.path())->newest_model(id(kSquare))->file);
  ASSERT_TRUE(provenance.ok()) << provenance.status().to_string();
  EXPECT_EQ(provenance->choice, other.choice);
  EXPECT_EQ(provenance->started_from, 1);
  ASSERT_TRUE(drop().ok());
  EXPECT_GE(lowest_psnr_db(store.path(), 100), kBoundDb) << "by both models";
  expect_clean(store.path());
}

TEST(LaterNight, GivesANewModelAsManyNightsAsTheOneBeforeServed) {
  const ScratchPath store("model_nights");
  record(store.path(), kSquare, 0, 40);
  night(store.path(), automatic(20));
  record(store.path(), kSquare, 40, 20);
  auto chosen = automatic(20);
  chosen.representation.nights.reset();
  EXPECT_EQ(night(store.path(), chosen).choice.nights, 3) << "40 and 20 snapshots of 20 each";
  record(store.path(), kSquare, 60, 2);
  EXPECT_LE(night(store.path(), chosen).choice.nights, 30);
}

TEST(LaterNight, PublishesNothingWhereNothingIsNewAndNothingIsGained) {
  const ScratchPath store("later_forced");
  record(store.path(), kSquare, 0, 40);
  auto chosen = automatic(20);
  chosen.starts_anew = true;
  night(store.path(), chosen);
  const auto before = ltm::read_manifest(store.path())->generation;
  chosen.force = true;
  const EntityReport report = night(store.path(), chosen);  // Makes the very same model.
  EXPECT_FALSE(report.is_model_new);
  EXPECT_EQ(report.choice.previous, report.choice.made);
  EXPECT_EQ(report.choice.new_snapshots, 0);
  EXPECT_EQ(report.snapshots, 0u);
  EXPECT_EQ(ltm::read_manifest(store.path())->generation, before);
}

TEST(LaterNight, LeavesTheStoreAsItWasWhenStoppedWhileThePreviousModelEncodes) {
  const ScratchPath store("later_stopped");
  record(store.path(), kSquare, 0, 20);
  const auto chosen = automatic(20);
  night(store.path(), chosen);
  record(store.path(), kSquare, 20, 18);
  const auto before = *ltm::read_manifest(store.path());
  std::stop_source stop;
  int encoded = 0;
  const ProgressSink sink = [&](const Progress& progress) {
    const bool is_whole = progress.what.starts_with("encode") && progress.done == 38;
    encoded += is_whole ? 1 : 0;
    if (encoded > 0 && !is_whole) stop.request_stop();  // The next one is of the model before.
  };
  EXPECT_EQ(consolidate(store.path(), chosen, sink, stop.get_token()).status().code(),
            StatusCode::kCancelled);
  EXPECT_GE(encoded, 1);
  EXPECT_EQ(ltm::read_manifest(store.path())->generation, before.generation);
  expect_clean(store.path());
  EXPECT_EQ(night(store.path(), chosen).choice.previous_version, 1);
}

TEST(LaterNight, EncodesWhatIsNewWithTheNewestModelWhereAskedTo) {
  const ScratchPath store("reuse");
  record(store.path(), kSquare, 0, 20);
  auto reusing = quick_consolidation();
  reusing.reuses_models = true;
  EXPECT_EQ(consolidate(store.path(), reusing, {}, {})->entities[0].skipped_reason,
            "Test/Scene/sim/square: has no model yet");
  const EntityReport trained = night(store.path(), quick_consolidation());
  const auto before = *ltm::read_manifest(store.path());
  record(store.path(), kSquare, 20, 4);
  const EntityReport reused = night(store.path(), reusing);
  EXPECT_EQ(reused.snapshots, 4u);
  EXPECT_EQ(reused.model_version, 1);
  EXPECT_FALSE(reused.is_model_new);
  EXPECT_EQ(reused.training.autoencoder_steps, 0);
  EXPECT_GT(reused.mean_psnr_db, trained.mean_psnr_db - 1.0);
  const auto after = *ltm::read_manifest(store.path());
  ASSERT_EQ(after.models.size(), 1u);
  EXPECT_EQ(after.models[0].checksum, before.models[0].checksum);
  EXPECT_EQ((*ltm::StoreReader::open(store.path()))->summary(id(kSquare))->latent_snapshots, 24u);
  reusing.force = true;
  EXPECT_EQ(night(store.path(), reusing).snapshots, 24u) << "all of them again";
  EXPECT_EQ(versions(store.path()), std::vector<int>{1});
  expect_clean(store.path());
}

TEST(LaterNight, ComparesModelsOfNumbersAloneWithoutABoundOfImages) {
  const ScratchPath store("numbers_nights");
  constexpr const char* kArm = "Test/Joints/sim/arm";
  auto chosen = automatic(20);
  chosen.representation.bound_db = 0;
  for (const int first : {0, 20}) {
    auto recorder = ltm::Recorder::open(store.path(), {});
    ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
    const auto times = scene_source(first + 20).times;
    for (int i = first; i < first + 20; ++i)
      ASSERT_TRUE(
          recorder
              ->commit({{{id(kArm), times[static_cast<size_t>(i)], {{scene_at(i, false), {}}}}}})
              .ok());
    ASSERT_TRUE(recorder->close().ok());
    const auto report = consolidate(store.path(), chosen, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().to_string();
    EXPECT_EQ(report->entities[0].skipped_reason, "");
    EXPECT_EQ(report->entities[0].choice.previous_version, first == 0 ? 0 : 1);
  }
  EXPECT_EQ((*ltm::StoreReader::open(store.path()))->summary(id(kArm))->latent_snapshots, 40u);
}

TEST(ModelChoice, CountsWhatIsNewForEveryNight) {
  encoders::ModelChoice choice{1, 30, 10, 5, {1000, 100, 0}, {900, 60, 292}};
  EXPECT_EQ(choice.previous.total(5), 1500);
  EXPECT_EQ(choice.made.total(5), 1492);
  EXPECT_FALSE(choice.keeps_previous());
  choice.made.model = 293;
  EXPECT_TRUE(choice.keeps_previous()) << "where it does not save half a percent";
  choice.previous_version = 0;
  EXPECT_FALSE(choice.keeps_previous());
}

}  // namespace
}  // namespace engram::training
