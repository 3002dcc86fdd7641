// SPDX-License-Identifier: Apache-2.0
#include "encoders/load_model.h"

#include <gtest/gtest.h>

#include <fstream>

#include "encoders/threads.h"
#include "ltm/core/file.h"
#include "tests/training/moving_scene.h"

namespace engram::encoders {
namespace {

using engram::testing::quick_options;
using engram::testing::scene_at;
using engram::testing::ScratchPath;

/// A model of the moving scene, trained for a few steps and loaded again.
class LoadModel : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    file_ = std::make_unique<ScratchPath>("load_model");
    const auto report = training::train_model(engram::testing::scene_source(24), quick_options(20),
                                              file_->path(), {}, {});
    ASSERT_TRUE(report.ok()) << report.status().to_string();
  }
  static void TearDownTestSuite() { file_.reset(); }

  static ltm::LoadedModel load() {
    auto model = load_model(file_->path());
    ENGRAM_CHECK(model.ok(), "{}", model.status().to_string());
    return std::move(model).value();
  }

  static std::unique_ptr<ScratchPath> file_;
};

std::unique_ptr<ScratchPath> LoadModel::file_;

TEST_F(LoadModel, DecodesIdenticallyEveryTime) {
  auto first = load();
  auto second = load();
  const std::vector<idf::Data> values{scene_at(3), scene_at(4), scene_at(5)};
  const auto latents = first.encoder->encode(values);
  ASSERT_TRUE(latents.ok()) << latents.status().to_string();
  const auto together = first.encoder->decode(*latents);
  ASSERT_TRUE(together.ok()) << together.status().to_string();
  for (size_t i = 0; i < values.size(); ++i) {
    const auto alone = second.encoder->decode(std::span(*latents).subspan(i, 1));
    EXPECT_EQ(alone->front(), (*together)[i]);
  }
}

TEST_F(LoadModel, DecodesAlikeOnOneAndOnTwoThreads) {
  auto model = load();
  std::vector<idf::Data> values;
  for (int i = 0; i < 6; ++i) values.push_back(scene_at(i));
  const auto latents = *model.encoder->encode(values);
  set_threads(1);
  const auto one = *model.encoder->decode(latents);
  set_threads(2);
  const auto two = *load().encoder->decode(latents);
  set_threads(1);
  for (size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(*one[i].at("joints"), *two[i].at("joints")) << "integers do not depend on threads";
    const auto a = one[i].at("image")->get<idf::NdArray>().bytes();
    const auto b = two[i].at("image")->get<idf::NdArray>().bytes();
    ASSERT_EQ(a.size(), b.size());
    int max = 0;
    for (size_t k = 0; k < a.size(); ++k)
      max = std::max(max, std::abs(std::to_integer<int>(a[k]) - std::to_integer<int>(b[k])));
    EXPECT_LE(max, 1);
  }
}

TEST_F(LoadModel, CodesConsecutiveValuesAsBlocks) {
  auto model = load();
  std::vector<idf::Data> values;
  for (int i = 0; i < 20; ++i) values.push_back(scene_at(i));
  const auto latents = model.encoder->encode(values);
  ASSERT_TRUE(latents.ok()) << latents.status().to_string();
  ASSERT_EQ(latents->size(), 20u);
  for (uint32_t i = 0; i < 20; ++i) {
    EXPECT_EQ((*latents)[i].place.count, 20u);
    EXPECT_EQ((*latents)[i].place.index, i);
  }
  EXPECT_EQ(latents->front().code.data(), latents->back().code.data());
  size_t alone = 0;
  for (const idf::Data& value : values)
    alone += model.encoder->encode({&value, 1})->front().code.size();
  EXPECT_LT(latents->front().code.size(), alone);
  // In any order, rows are those of reading on.
  const auto in_order = model.encoder->decode(*latents);
  ASSERT_TRUE(in_order.ok()) << in_order.status().to_string();
  for (const size_t i : {18, 2, 19, 17, 3, 1}) {
    const auto one = model.encoder->decode({&(*latents)[i], 1});
    ASSERT_TRUE(one.ok()) << one.status().to_string();
    EXPECT_EQ(one->front(), (*in_order)[i]) << i;
  }
}

TEST_F(LoadModel, RejectsAPlaceOutsideItsBlock) {
  auto model = load();
  const std::vector<idf::Data> values{scene_at(3), scene_at(4)};
  auto latents = *model.encoder->encode(values);
  latents[0].place = {2, 2};
  EXPECT_EQ(model.encoder->decode(latents).status().code(), StatusCode::kDataLoss);
  latents[0].place = {0, 3};  // The checksum knows how many there are.
  EXPECT_EQ(model.encoder->decode(latents).status().code(), StatusCode::kDataLoss);
}

TEST_F(LoadModel, KeepsTheRemainderAsItWas) {
  auto model = load();
  const idf::Data value = scene_at(7);
  const auto decoded = model.encoder->decode(*model.encoder->encode({&value, 1}));
  EXPECT_EQ(decoded->front().at("label")->get<std::string>(), "square 7");
}

TEST_F(LoadModel, DetectsADamagedLatent) {
  auto model = load();
  const idf::Data value = scene_at(7);
  auto latents = *model.encoder->encode({&value, 1});
  const Buffer code = latents[0].code;
  for (size_t byte = 0; byte < code.size(); ++byte) {
    std::vector<std::byte> damaged(code.bytes().begin(), code.bytes().end());
    damaged[byte] ^= std::byte{0xff};
    latents[0].code = Buffer::take(std::move(damaged));
    EXPECT_EQ(model.encoder->decode(latents).status().code(), StatusCode::kDataLoss) << byte;
  }
  latents[0].code = Buffer();
  EXPECT_EQ(model.encoder->decode(latents).status().code(), StatusCode::kDataLoss);
}

TEST_F(LoadModel, RejectsARemainderOfAnotherLayout) {
  auto model = load();
  const idf::Data value = scene_at(7);
  auto latents = *model.encoder->encode({&value, 1});
  latents[0].remainder.clear();
  EXPECT_EQ(model.encoder->decode(latents).status().code(), StatusCode::kDataLoss);
}

TEST_F(LoadModel, RejectsAValueOfAnotherLayout) {
  auto model = load();
  const idf::Data value("text");
  EXPECT_EQ(model.encoder->encode({&value, 1}).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(model.predictor->predict(std::span(&value, 1), 1).status().code(),
            StatusCode::kInvalidArgument);
}

TEST_F(LoadModel, PredictsAsManyStepsAsAskedFromOneValue) {
  auto model = load();
  const idf::Data value = scene_at(7);
  const auto predicted = model.predictor->predict(std::span(&value, 1), 8);
  ASSERT_TRUE(predicted.ok()) << predicted.status().to_string();
  EXPECT_EQ(predicted->size(), 8u);
  EXPECT_EQ(model.predictor->predict({}, 1).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(model.predictor->predict(std::span(&value, 1), 0).status().code(),
            StatusCode::kInvalidArgument);
}

TEST_F(LoadModel, IsAModelLoader) {
  const ltm::ModelLoader loader = load_model;
  EXPECT_EQ(loader(file_->path())->predictor->name(), "deep");
  EXPECT_EQ(loader("/nowhere/model.h5").status().code(), StatusCode::kNotFound);
}

TEST_F(LoadModel, RejectsTruncatedFiles) {
  const ScratchPath truncated("truncated");
  const Buffer whole = *read_file(file_->path());
  for (const size_t share : {0, 10, 50, 90, 99}) {
    const auto text = as_text(whole.bytes().first(whole.size() * share / 100));
    std::ofstream(truncated.path(), std::ios::binary | std::ios::trunc) << text;
    EXPECT_EQ(load_model(truncated.path()).status().code(), StatusCode::kDataLoss) << share << " %";
  }
}

TEST_F(LoadModel, SurvivesDamagedFiles) {
  const ScratchPath damaged("damaged");
  const Buffer whole = *read_file(file_->path());
  int rejected = 0;
  for (size_t i = 0; i < 40; ++i) {
    std::string text(as_text(whole.bytes()));
    const size_t at = text.size() * i / 40;
    for (size_t k = at; k < std::min(at + 64, text.size()); ++k)
      text[k] = static_cast<char>(~text[k]);
    std::ofstream(damaged.path(), std::ios::binary | std::ios::trunc) << text;
    if (!load_model(damaged.path()).ok()) ++rejected;
  }
  EXPECT_GT(rejected, 20);
}

}  // namespace
}  // namespace engram::encoders
