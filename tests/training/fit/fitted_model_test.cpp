// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "encoders/deep_model_file.h"
#include "encoders/model_vectors.h"
#include "ltm/core/file.h"
#include "tests/training/moving_scene.h"
#include "training/fit/trainer.h"

namespace engram::training {
namespace {

using engram::testing::quick_options;
using engram::testing::scene_at;
using engram::testing::scene_source;
using engram::testing::ScratchPath;

std::vector<idf::Data> scenes(int count) {
  std::vector<idf::Data> values;
  for (int i = 0; i < count; ++i) values.push_back(scene_at(i));
  return values;
}

/// What is coded before a model is written must be decoded alike by the one that is read.
TEST(FittedModel, CodesAndDecodesAsTheOneThatItsFileGives) {
  const ScratchPath path("fitted");
  const auto fitted = fit_model(scene_source(24), quick_options(20), {}, {});
  ASSERT_TRUE(fitted.ok()) << fitted.status().to_string();
  ASSERT_TRUE(encoders::save_model(*fitted->model, path.path()).ok());
  const auto read = encoders::read_model(path.path());
  ASSERT_TRUE(read.ok()) << read.status().to_string();
  EXPECT_EQ(fitted->model->provenance, (*read)->provenance);
  const auto values = scenes(16);
  const auto mine = fitted->model->encode(values), its = (*read)->encode(values);
  ASSERT_TRUE(mine.ok() && its.ok());
  EXPECT_TRUE(std::ranges::equal(mine->front().code.bytes(), its->front().code.bytes()));
  const auto my_decoder = encoders::make_encoder(fitted->model);
  const auto its_decoder = encoders::make_encoder(*read);
  EXPECT_EQ(*my_decoder->decode(*mine), *its_decoder->decode(*its));
}

/// The examples of self tests would stay in models after they were forgotten.
TEST(FittedModel, HasNothingOfItsImagesInItsSelfTest) {
  TrainOptions options = quick_options(1);
  options.has_networks = false;
  std::vector<std::vector<uint8_t>> codes;
  for (const int first : {0, 7}) {
    TrainingSource source = scene_source(24, 1, true, false);
    source.read = [first](size_t i) -> Result<idf::Data> {
      return scene_at(static_cast<int>(i) + first, true, false);
    };
    const auto fitted = fit_model(source, options, {}, {});
    ASSERT_TRUE(fitted.ok()) << fitted.status().to_string();
    const ScratchPath path("self_test_" + std::to_string(first));
    ASSERT_TRUE(encoders::save_model(*fitted->model, path.path()).ok());
    const auto file = h5::File::open(path.path());
    ASSERT_TRUE(file.ok());
    const auto code = encoders::read_vector<uint8_t>(*file, "/self_test/code");
    ASSERT_TRUE(code.ok()) << code.status().to_string();
    codes.push_back(*code);
  }
  EXPECT_EQ(codes[0], codes[1]);
}

TEST(FittedModel, HasWhatItWasChosenOverInItsFileAsIfItHadBeenKnownBefore) {
  const ScratchPath noted("noted"), written("written");
  const auto fitted = fit_model(scene_source(24), quick_options(20), {}, {});
  ASSERT_TRUE(fitted.ok()) << fitted.status().to_string();
  ASSERT_TRUE(encoders::save_model(*fitted->model, noted.path()).ok());
  const encoders::ModelChoice choice{3, 24, 20, 30, {1000, 2000, 30000}, {900, 1500, 31000}};
  fitted->model->provenance.choice = choice;
  ASSERT_TRUE(encoders::save_model(*fitted->model, written.path()).ok());
  ASSERT_TRUE(encoders::note_choice(choice, noted.path()).ok());
  const auto a = read_file(noted.path()), b = read_file(written.path());
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_TRUE(std::ranges::equal(a->bytes(), b->bytes()));
  EXPECT_EQ(encoders::read_provenance(noted.path())->choice, choice);
}

}  // namespace
}  // namespace engram::training
