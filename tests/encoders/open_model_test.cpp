// SPDX-License-Identifier: Apache-2.0
#include "encoders/open_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "encoders/load_model.h"
#include "tests/training/moving_scene.h"

namespace engram::encoders {
namespace {

using engram::testing::quick_options;
using engram::testing::scene_at;
using engram::testing::ScratchPath;

/// A model of the moving scene, looked into.
class OpenedModel : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    file_ = std::make_unique<ScratchPath>("open_model");
    const auto report = training::train_model(engram::testing::scene_source(24), quick_options(20),
                                              file_->path(), {}, {});
    ASSERT_TRUE(report.ok()) << report.status().to_string();
  }
  static void TearDownTestSuite() { file_.reset(); }

  void SetUp() override {
    auto model = OpenModel::open(file_->path());
    ASSERT_TRUE(model.ok()) << model.status().to_string();
    model_.emplace(std::move(model).value());
    for (int i = 0; i < 5; ++i) values_.push_back(scene_at(i));
  }

  static std::unique_ptr<ScratchPath> file_;
  std::optional<OpenModel> model_;
  std::vector<idf::Data> values_;
};

std::unique_ptr<ScratchPath> OpenedModel::file_;

TEST_F(OpenedModel, NamesWhatItsArraysAre) {
  ASSERT_EQ(model_->images().size(), 1U);
  EXPECT_EQ(model_->images()[0].path, "image");
  EXPECT_EQ(model_->images()[0].coarse.channels, quick_options(1).coarse_channels);
  EXPECT_EQ(model_->numbers(), (std::vector<std::string>{"joints", "joints", "load"}));
  const auto arrays = model_->encode(values_);
  ASSERT_TRUE(arrays.ok()) << arrays.status().to_string();
  EXPECT_EQ(arrays->scenes.size(), 5U);
  EXPECT_EQ(arrays->images[0].size(), 5 * model_->images()[0].count());
  EXPECT_EQ(arrays->numbers.size(), 15U);
  EXPECT_EQ(arrays->remainders.size(), 5U);
}

TEST_F(OpenedModel, TellsTheBackgroundOfEachImage) {
  const auto arrays = model_->encode(values_);
  ASSERT_TRUE(arrays.ok()) << arrays.status().to_string();
  ASSERT_EQ(arrays->own[0].size(), values_.size());
  EXPECT_EQ(arrays->own[0][0].count(), 0) << "only blocks of a store may have their own";
  const idf::NdArray background = model_->background(*arrays, 0, 0);
  const LatentMember& member = model_->images()[0];
  ASSERT_EQ(background.shape().size(), 3U);
  EXPECT_EQ(background.shape()[0], member.channels);
  EXPECT_EQ(background.shape()[1], 8 * member.fine.height);
  EXPECT_EQ(background.shape()[2], 8 * member.fine.width);
  float max = 0;
  for (const float level : background.values<float>()) max = std::max(max, level);
  EXPECT_GT(max, 20) << "grey levels";
  EXPECT_LT(max, 300);

  // A background that a block carries counts instead.
  LatentArrays with_own = *arrays;
  using engram::testing::kHeight;
  using engram::testing::kWidth;
  with_own.own[0][1] = idf::NdArray::take({kHeight, kWidth, 3},
                                          std::vector<uint8_t>(size_t{3} * kHeight * kWidth, 7));
  const idf::NdArray own = model_->background(with_own, 0, 1);
  for (const float level : own.values<float>()) EXPECT_EQ(level, 7);
}

TEST_F(OpenedModel, DecodesWhatTheStoreWouldAnswer) {
  const auto loaded = *load_model(file_->path());
  const auto stored = *loaded.encoder->encode(values_);
  // Images are decoded with the numbers beside them, and a store keeps these within a bound: with
  // those before it a pixel may round to the next grey level.
  LatentArrays arrays = *model_->encode(values_);
  arrays.numbers = model_->stored(stored)->numbers;
  const auto decoded = model_->decode(arrays);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  const auto answered = *loaded.encoder->decode(stored);
  for (size_t i = 0; i < values_.size(); ++i) {
    EXPECT_EQ(*(*decoded)[i].at("image"), *answered[i].at("image")) << i;
    EXPECT_EQ(*(*decoded)[i].at("label"), *values_[i].at("label"));
  }
}

TEST_F(OpenedModel, ReadsTheSameOutOfStoredLatents) {
  const auto stored = *load_model(file_->path())->encoder->encode(values_);
  const auto found = model_->stored(stored);
  ASSERT_TRUE(found.ok()) << found.status().to_string();
  const auto made = model_->encode(values_);
  EXPECT_EQ(found->images, made->images);
  EXPECT_EQ(found->scenes, made->scenes);
  EXPECT_EQ(found->is_latent[0], std::vector<bool>(5, true));
  auto damaged = stored;
  damaged[1].place = {7, 5};
  EXPECT_EQ(model_->stored(damaged).status().code(), StatusCode::kDataLoss);
}

TEST_F(OpenedModel, RefusesArraysOfAnotherModel) {
  const LatentArrays good = *model_->encode(values_);
  const auto code_of = [&](auto change) {
    LatentArrays arrays = good;
    change(arrays);
    return model_->decode(arrays).status().code();
  };
  const auto bad = StatusCode::kInvalidArgument;
  EXPECT_EQ(code_of([](auto& arrays) { arrays.images[0].pop_back(); }), bad);
  EXPECT_EQ(code_of([](auto& arrays) { arrays.images.clear(); }), bad);
  EXPECT_EQ(code_of([](auto& arrays) { arrays.numbers.push_back(1); }), bad);
  EXPECT_EQ(code_of([](auto& arrays) { arrays.scenes[2] = 77; }), bad);
  EXPECT_EQ(code_of([](auto& arrays) { arrays.remainders.pop_back(); }), bad);
  EXPECT_EQ(code_of([](auto& arrays) { arrays.remainders[0].clear(); }), bad);
  EXPECT_EQ(code_of([](auto&) {}), StatusCode::kOk);
}

TEST_F(OpenedModel, HasWeightsByNameAndACurve) {
  const auto weights = model_->weights();
  std::set<std::string> names;
  int64_t numbers = 0;
  for (const NamedWeights& one : weights) {
    names.insert(one.name);
    numbers += one.values.count();
  }
  EXPECT_EQ(names.size(), weights.size());
  EXPECT_TRUE(std::ranges::any_of(
      names, [](const std::string& name) { return name.ends_with("background"); }));
  EXPECT_GT(numbers, 10'000);
  const auto& curve = model_->provenance().curve;
  ASSERT_GT(curve.size(), 10U);
  EXPECT_EQ(curve.front().phase, 0);
  EXPECT_EQ(curve.back().phase, 2);
  EXPECT_GT(curve[5].psnr_db, 5);
  EXPECT_EQ(curve[5].seconds, 0) << "the same steps give the same file";
}

TEST_F(OpenedModel, PredictsAsItsPredictorDoes) {
  const auto ahead = model_->predictor().predict(values_, 2);
  ASSERT_TRUE(ahead.ok()) << ahead.status().to_string();
  const auto again = load_model(file_->path())->predictor->predict(values_, 2);
  EXPECT_EQ((*ahead)[1].value, (*again)[1].value);
}

}  // namespace
}  // namespace engram::encoders
