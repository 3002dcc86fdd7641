// SPDX-License-Identifier: Apache-2.0
#include "training/fit/warm_start.h"

#include <gtest/gtest.h>

#include "encoders/load_model.h"
#include "encoders/model_file.h"
#include "ltm/core/file.h"
#include "ltm/store/checksum.h"
#include "tests/training/moving_scene.h"
#include "training/fit/checkpoint.h"
#include "training/fit/dataset.h"
#include "training/fit/load_dataset.h"
#include "training/fit/trainer.h"

namespace engram::training {
namespace {

using engram::testing::content_of;
using engram::testing::quick_options;
using engram::testing::scene_at;
using engram::testing::scene_source;
using engram::testing::ScratchPath;
using torch::Tensor;

/// The same scene in a room of another colour.
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

/// Two recordings of `count` snapshots, the second one in another room.
TrainingSource grown_source(int count) {
  TrainingSource source = scene_source(2 * count, 2);
  source.read = [=](size_t i) -> Result<idf::Data> {
    const int at = static_cast<int>(i);
    return at < count ? scene_at(at) : recoloured(at - count);
  };
  for (int i = 0; i < 2 * count; ++i) source.is_known.push_back(i < count);
  return source;
}

PreviousModel previous_of(const std::filesystem::path& file, int version) {
  return {file, version, *ltm::checksum_of_file(file)};
}

/// A model of scene_source(20), trained for `steps`.
class TrainedBefore : public ::testing::Test {
 protected:
  void train_before(int steps) {
    ASSERT_TRUE(train_model(scene_source(20), quick_options(steps), before_.path(), {}, {}).ok());
  }

  [[nodiscard]] TrainingSource following(TrainingSource source) const {
    source.previous = previous_of(before_.path(), 3);
    return source;
  }

  ScratchPath before_{"warm_before"};
};

TEST_F(TrainedBefore, IsWhereTrainingGoesOnFrom) {
  train_before(300);
  const ScratchPath warm("warm"), cold("cold");
  const auto source = scene_source(24);
  const auto started = train_model(following(source), quick_options(30), warm.path(), {}, {});
  const auto anew = train_model(source, quick_options(30), cold.path(), {}, {});
  ASSERT_TRUE(started.ok()) << started.status().to_string();
  ASSERT_TRUE(anew.ok()) << anew.status().to_string();
  EXPECT_GT(started->training_psnr_db, anew->training_psnr_db + 3);
  EXPECT_EQ(started->started_from, 3);
  EXPECT_EQ(anew->started_from, 0);
  EXPECT_EQ(started->notes.front(), "training started from v3");
  const auto provenance = encoders::read_provenance(warm.path());
  ASSERT_TRUE(provenance.ok()) << provenance.status().to_string();
  EXPECT_EQ(provenance->started_from, 3);
  EXPECT_EQ(encoders::read_provenance(cold.path())->started_from, 0);
}

TEST_F(TrainedBefore, AndSeedMakeTheSameModelAgain) {
  train_before(10);
  const auto source = following(scene_source(24));
  const ScratchPath a("warm_a"), b("warm_b"), cold("warm_c");
  ASSERT_TRUE(train_model(source, quick_options(20), a.path(), {}, {}).ok());
  ASSERT_TRUE(train_model(source, quick_options(20), b.path(), {}, {}).ok());
  ASSERT_TRUE(train_model(scene_source(24), quick_options(20), cold.path(), {}, {}).ok());
  EXPECT_GT(content_of(a.path()).size(), 10000u);
  EXPECT_TRUE(content_of(a.path()) == content_of(b.path()));
  EXPECT_FALSE(content_of(a.path()) == content_of(cold.path()));
}

TEST_F(TrainedBefore, LeavesTheCheckpointsOfATrainingThatGoesOnFromItWhole) {
  train_before(10);
  const auto source = following(grown_source(20));
  const ScratchPath whole("warm_whole"), broken("warm_broken"), kept("warm_kept");
  ASSERT_TRUE(train_model(source, quick_options(20), whole.path(), {}, {}).ok());
  TrainControl control;
  control.checkpoint = kept.path();
  for (const uint64_t step : {6u, 16u}) {
    std::stop_source stop;
    const ProgressSink sink = [&](const Progress& progress) {
      if (progress.done >= step) stop.request_stop();
    };
    EXPECT_EQ(train_model(source, quick_options(20), broken.path(), sink, stop.get_token(), control)
                  .status()
                  .code(),
              StatusCode::kCancelled);
  }
  const auto report = train_model(source, quick_options(20), broken.path(), {}, {}, control);
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_NE(report->notes.at(1).find("went on"), std::string::npos);
  EXPECT_TRUE(content_of(broken.path()) == content_of(whole.path()));
}

TEST_F(TrainedBefore, IsPartOfTheKeyOfCheckpoints) {
  train_before(4);
  const auto options = quick_options(4);
  const auto source = scene_source(24);
  TrainingSource started = following(source);
  const uint64_t key = checkpoint_key(started, options);
  EXPECT_NE(key, checkpoint_key(source, options));
  EXPECT_EQ(key, checkpoint_key(started, options));
  started.previous->checksum ^= 1;
  EXPECT_NE(key, checkpoint_key(started, options));
  started = following(source);
  started.is_known.assign(24, true);
  EXPECT_NE(key, checkpoint_key(started, options));
}

TEST(CheckpointKey, LeavesThreadsOpenWhereTimeIsLimited) {
  const auto source = scene_source(24);
  const auto key = [&](std::optional<int64_t> steps, int threads) {
    auto options = quick_options(4);
    options.steps = steps;
    options.threads = threads;
    return checkpoint_key(source, options);
  };
  EXPECT_EQ(key({}, 1), key({}, 2));
  EXPECT_NE(key(4, 1), key(4, 2));
  EXPECT_NE(key({}, 1), key(4, 1));
}

TEST_F(TrainedBefore, IsNotGoneOnFromWhereItDoesNotFit) {
  train_before(4);
  const auto why = [&](const TrainingSource& source, const TrainOptions& options) {
    const auto start = find_start(following(source), options);
    EXPECT_TRUE(start.ok()) << start.status().to_string();
    return start->model ? "" : start->note;
  };
  const auto fit = scene_source(24);
  EXPECT_EQ(why(fit, quick_options(4)), "");
  auto options = quick_options(4);
  options.width = 32;
  EXPECT_EQ(why(fit, options),
            "training started anew, not from v3: it has 16 features, what there is to save by now "
            "asks for 32");
  options = quick_options(4);
  options.coarse_channels = 16;
  EXPECT_NE(why(fit, options).find("it has 12 and 8 latent channels, not 16 and 8"),
            std::string::npos);
  options = quick_options(4);
  options.variant = encoders::TrainingVariant::kAutoencoder;
  EXPECT_NE(why(fit, options).find("variant"), std::string::npos);
  EXPECT_NE(why(scene_source(24, 1, true, false), quick_options(4)).find("another layout"),
            std::string::npos);
  const ScratchPath file("warm_anew");
  options = quick_options(4);
  options.width = 32;
  const auto report = train_model(following(fit), options, file.path(), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->started_from, 0);
  EXPECT_NE(report->notes.front().find("anew"), std::string::npos);
  ASSERT_TRUE(replace_file(before_.path(), as_bytes("no model")).ok());
  EXPECT_NE(why(fit, quick_options(4)).find("anew"), std::string::npos);
}

TEST_F(TrainedBefore, MakesNoBackgroundsWhereThereAreNoNetworks) {
  train_before(20);
  auto options = quick_options(4);
  options.has_networks = false;
  const auto data = load_dataset(grown_source(20), options, nullptr, {});
  ASSERT_TRUE(data.ok()) << data.status().to_string();
  EXPECT_TRUE(data->backgrounds.empty());
  EXPECT_TRUE(data->coded_backgrounds.empty());
  EXPECT_EQ(data->scene.sizes(), (torch::IntArrayRef{40}));
  EXPECT_EQ(data->scene.abs().sum().item<int64_t>(), 0);
}

TEST_F(TrainedBefore, KeepsItsBackgroundsWhereAnotherSceneIsNew) {
  train_before(20);
  const auto options = quick_options(4);
  const auto source = following(grown_source(20));
  const auto start = find_start(source, options);
  ASSERT_TRUE(start.ok() && start->model);
  const auto data = load_dataset(source, options, start->model.get(), {});
  ASSERT_TRUE(data.ok()) << data.status().to_string();
  EXPECT_EQ(data->known_scenes, 1);
  ASSERT_EQ(data->scenes(), 2);
  for (int64_t row = 0; row < 40; ++row)
    EXPECT_EQ(data->scene[row].item<int64_t>(), row < 20 ? 0 : 1) << row;
  for (size_t row = 0; row < 40; ++row) EXPECT_EQ(data->is_known[row], row < 20) << row;

  auto& from = *start->model;
  auto sizes = from.autoencoder->shape.sizes;
  sizes.scenes = 2;
  encoders::DeepModel to(data->plan, sizes);
  copy_weights(from, to);
  int grown = 0;
  const auto compare = [&](const torch::nn::Module& known, const torch::nn::Module& found) {
    const auto all = known.named_parameters();
    for (const auto& item : found.named_parameters()) {
      const Tensor* old = all.find(item.key());
      ASSERT_NE(old, nullptr) << item.key();
      if (old->sizes() == item.value().sizes()) {
        EXPECT_TRUE(old->equal(item.value())) << item.key();
        continue;
      }
      ++grown;
      EXPECT_EQ(item.value().size(0), 2) << item.key();
      EXPECT_TRUE(old->equal(item.value().slice(0, 0, 1))) << item.key();
    }
  };
  compare(*from.autoencoder, *to.autoencoder);
  compare(*from.dynamics, *to.dynamics);
  EXPECT_GE(grown, 1);
}

TEST_F(TrainedBefore, SharesItsBackgroundWithANewRecordingThatLooksAlike) {
  train_before(20);
  auto source = following(scene_source(40, 2));
  source.is_known.assign(40, false);
  const auto options = quick_options(4);
  const auto start = find_start(source, options);
  const auto data = load_dataset(source, options, start->model.get(), {});
  ASSERT_TRUE(data.ok()) << data.status().to_string();
  EXPECT_EQ(data->scenes(), 1);
}

TEST_F(TrainedBefore, NormalisesNumbersAsItDidUnlessTheyGrew) {
  train_before(4);
  const auto options = quick_options(4);
  const auto start = find_start(following(scene_source(20)), options);
  ASSERT_TRUE(start.ok() && start->model);
  auto source = scene_source(20);
  source.read = [](size_t i) -> Result<idf::Data> {
    idf::Data value = scene_at(static_cast<int>(i));
    const double load = value.at("load")->get<double>();
    value.get_if<idf::Dict>()->set("load", 100 * load);
    return value;
  };
  const auto data = load_dataset(source, options, start->model.get(), {});
  ASSERT_TRUE(data.ok()) << data.status().to_string();
  ASSERT_EQ(data->mean.size(), 3u);
  int same = 0;
  for (size_t i = 0; i < 3; ++i) {
    const bool is_same = data->deviation[i] == start->model->deviation[i];
    same += is_same ? 1 : 0;
    EXPECT_EQ(data->mean[i] == start->model->mean[i], is_same);
  }
  EXPECT_EQ(same, 2) << "all but the one that is a hundred times as large";
}

TEST_F(TrainedBefore, IsToldInTheSpansOfWhatLearnedFromIt) {
  train_before(4);
  TrainingSource later = scene_source(24);
  for (Time& time : later.times) time += std::chrono::hours(1);
  const ScratchPath file("warm_spans");
  ASSERT_TRUE(train_model(following(later), quick_options(4), file.path(), {}, {}).ok());
  const auto provenance = encoders::read_provenance(file.path());
  ASSERT_TRUE(provenance.ok()) << provenance.status().to_string();
  ASSERT_EQ(provenance->autoencoder_spans.size(), 2u);
  EXPECT_EQ(provenance->autoencoder_spans[0].first, scene_source(1).times[0]);
  EXPECT_EQ(provenance->autoencoder_spans[1].first, later.times[0]);
  EXPECT_EQ(provenance->dynamics_spans.size(), 2u);
}

}  // namespace
}  // namespace engram::training
