// SPDX-License-Identifier: Apache-2.0
#include "training/forms/block_choice.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "encoders/deep_model_file.h"
#include "tests/training/moving_scene.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {
namespace {

using engram::testing::quick_options;
using engram::testing::scene_at;
using engram::testing::scene_source;
using engram::testing::ScratchPath;

constexpr size_t kFirst = 3, kCount = 12;

/// A model that was trained briefly, whose numbers are kept so coarsely that images show it.
class BlockChoiceTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const ScratchPath file("block_choice");
    auto train = quick_options(150);
    train.number_bound = 0.8;
    ASSERT_TRUE(train_model(scene_source(24), train, file.path(), {}, {}).ok());
    auto model = encoders::read_model(file.path());
    ASSERT_TRUE(model.ok()) << model.status().to_string();
    model_ = *std::move(model);
  }
  static void TearDownTestSuite() { model_.reset(); }

  static std::vector<idf::Data> values() {
    std::vector<idf::Data> values;
    for (size_t i = kFirst; i < kFirst + kCount; ++i)
      values.push_back(scene_at(static_cast<int>(i)));
    return values;
  }

  /// Without video, so that latents compete with what has no loss alone.
  static RepresentationOptions options(double bound_db) {
    RepresentationOptions options;
    options.bound_db = bound_db;
    options.video = "none";
    options.few_refine_steps = 0;
    return options;
  }

  /// PSNR of each snapshot as a query sees it.
  static std::vector<double> psnr_of(const std::vector<ltm::Latent>& latents) {
    const auto decoded = encoders::make_encoder(model_)->decode(latents);
    EXPECT_TRUE(decoded.ok()) << decoded.status().to_string();
    std::vector<double> psnr;
    for (size_t i = 0; i < latents.size(); ++i)
      psnr.push_back(psnr_db(compare(values()[i], (*decoded)[i])->image_mse));
    return psnr;
  }

  static double lowest(const std::vector<ltm::Latent>& latents) {
    return std::ranges::min(psnr_of(latents));
  }

  /// PSNR of latents alone, the lowest first.
  static std::vector<double> psnr_alone() {
    RepresentationOptions alone = options(0);
    alone.kind = Representation::kLatents;
    std::vector<double> psnr = psnr_of(*BlockChoice(*model_, alone).encode(values()));
    std::ranges::sort(psnr);
    return psnr;
  }

  static std::shared_ptr<encoders::DeepModel> model_;
};

std::shared_ptr<encoders::DeepModel> BlockChoiceTest::model_;

TEST_F(BlockChoiceTest, AddsResidualsWhereLatentsMissTheBound) {
  const auto alone = psnr_alone();
  const double bound_db = alone[kCount / 2] + 0.1;
  BlockChoice choice(*model_, options(bound_db));
  const auto latents = choice.encode(values());
  ASSERT_TRUE(latents.ok()) << latents.status().to_string();
  EXPECT_GE(lowest(*latents), bound_db);
  const auto counts = choice.counts();
  EXPECT_GT(counts.residual_rows, 0);
  EXPECT_EQ(counts.residual_rows, counts.below_bound_rows);
  EXPECT_EQ(counts.residual_rows + counts.latent_rows, static_cast<int64_t>(kCount));
  EXPECT_EQ(counts.residual_kept_bytes + counts.latent_kept_bytes, counts.kept_bytes);
  EXPECT_EQ(counts.residual_bytes, counts.kept_bytes);
  EXPECT_GT(counts.residual_bytes, counts.latent_bytes);
  EXPECT_LT(counts.residual_bytes, counts.lossless_bytes);
}

TEST_F(BlockChoiceTest, CorrectsLatentsWithoutLookingAtVideo) {
  const double bound_db = psnr_alone()[kCount / 2] + 0.1;
  RepresentationOptions corrected = options(bound_db);
  corrected.kind = Representation::kCorrected;
  BlockChoice choice(*model_, corrected);
  const auto latents = choice.encode(values());
  ASSERT_TRUE(latents.ok()) << latents.status().to_string();
  EXPECT_GE(lowest(*latents), bound_db);
  const auto counts = choice.counts();
  EXPECT_GT(counts.residual_rows, 0);
  EXPECT_EQ(counts.residual_rows + counts.latent_rows, static_cast<int64_t>(kCount));
  EXPECT_EQ(counts.video_bytes + counts.lossless_bytes, 0);
  corrected.bound_db = kLargestPsnrDb;
  EXPECT_EQ(lowest(*BlockChoice(*model_, corrected).encode(values())), kLargestPsnrDb);
}

TEST_F(BlockChoiceTest, KeepsAnyBoundAndNeverMoreThanTheBestFormAlone) {
  for (const double bound_db : {20.0, 28.0, 34.0, 40.0, 48.0}) {
    RepresentationOptions chosen = options(bound_db);
    chosen.video = "h264";
    chosen.video_effort = 1;
    BlockChoice choice(*model_, chosen);
    const auto latents = choice.encode(values());
    ASSERT_TRUE(latents.ok()) << latents.status().to_string();
    EXPECT_GE(lowest(*latents), bound_db);
    const auto counts = choice.counts();
    EXPECT_LE(counts.kept_bytes, counts.residual_bytes) << bound_db;
    EXPECT_LE(counts.kept_bytes, counts.video_bytes) << bound_db;
    EXPECT_LE(counts.kept_bytes, counts.lossless_bytes) << bound_db;
    EXPECT_EQ(counts.latent_rows + counts.refined_rows + counts.residual_rows + counts.video_rows +
                  counts.lossless_rows,
              counts.rows);
  }
}

TEST_F(BlockChoiceTest, KeepsWithoutLossWhatNoResidualReaches) {
  BlockChoice choice(*model_, options(kLargestPsnrDb));
  const auto latents = choice.encode(values());
  ASSERT_TRUE(latents.ok()) << latents.status().to_string();
  EXPECT_EQ(lowest(*latents), kLargestPsnrDb);
}

TEST_F(BlockChoiceTest, RefinesOnlyWhereTheBoundIsMissedByLittle) {
  const double worst = psnr_alone().front();
  const auto tried = [&](double bound_db, int steps) {
    RepresentationOptions some = options(bound_db);
    some.few_refine_steps = 2;
    some.refine_steps = steps;
    BlockChoice choice(*model_, some);
    EXPECT_TRUE(choice.encode(values()).ok());
    return choice.counts().refine_tried_rows;
  };
  EXPECT_EQ(tried(worst - 0.1, 0), 0);
  EXPECT_EQ(tried(worst + 1.4, 0), static_cast<int64_t>(kCount));
  EXPECT_EQ(tried(worst + 1.6, 0), 0);
  EXPECT_EQ(tried(worst + 1.6, 2), static_cast<int64_t>(kCount));
}

/// Codes of three blocks of four snapshots each, whose videos are found together, or one by one.
std::vector<std::vector<std::byte>> coded(encoders::DeepModel& model,
                                          std::span<const idf::Data> values,
                                          const RepresentationOptions& options, bool is_ahead) {
  BlockChoice choice(model, options);
  std::vector<std::span<const idf::Data>> blocks;
  for (size_t first = 0; first < values.size(); first += 4)
    blocks.push_back(values.subspan(first, 4));
  size_t told = 0;
  const auto tell = [&told](size_t rows) {
    told = rows;
    return Status();
  };
  if (is_ahead) {
    EXPECT_TRUE(choice.find_ahead(blocks, {}, tell).ok());
    EXPECT_GT(told, 0U);
  }
  std::vector<std::vector<std::byte>> codes;
  for (const auto& block : blocks) {
    const auto latents = choice.encode(block);
    EXPECT_TRUE(latents.ok()) << latents.status().to_string();
    if (!latents.ok()) return {};
    const auto code = latents->front().code.bytes();
    codes.emplace_back(code.begin(), code.end());
  }
  EXPECT_EQ(choice.video_encodes().size(), 3U);  // Each chain is searched for once.
  return codes;
}

TEST_F(BlockChoiceTest, CodesTheSameWhetherVideosAreFoundAheadAndInHowManyThreads) {
  auto chosen = options(30);
  chosen.video = "h264";
  chosen.video_effort = 1;
  chosen.video_tolerance_db = 0;  // The search ends at the same quality wherever it begins.
  const auto all = values();
  const auto one_by_one = coded(*model_, all, chosen, false);
  EXPECT_EQ(coded(*model_, all, chosen, true), one_by_one);
  chosen.threads = 3;
  EXPECT_EQ(coded(*model_, all, chosen, true), one_by_one);
}

TEST_F(BlockChoiceTest, FindsNothingAheadWhereLatentsAreKept) {
  auto alone = options(0);
  alone.kind = Representation::kLatents;
  BlockChoice choice(*model_, alone);
  EXPECT_FALSE(choice.finds_videos());
  const auto all = values();
  const std::vector<std::span<const idf::Data>> blocks{all};
  EXPECT_TRUE(choice.find_ahead(blocks).ok());
  EXPECT_TRUE(choice.video_encodes().empty());
  EXPECT_TRUE(choice.encode(all).ok());
}

TEST_F(BlockChoiceTest, SaysWhichLatentsWereRefined) {
  RepresentationOptions alone = options(0);
  alone.kind = Representation::kLatents;
  alone.refine_steps = 30;
  BlockChoice choice(*model_, alone);
  const auto latents = choice.encode(values());
  ASSERT_TRUE(latents.ok()) << latents.status().to_string();
  EXPECT_EQ(choice.counts().refined_rows, static_cast<int64_t>(kCount));
  const auto codes = encoders::describe_block(latents->front().code.bytes(), kCount, 1);
  ASSERT_TRUE(codes.ok()) << codes.status().to_string();
  EXPECT_TRUE(codes->chains.front().front().is_refined);
}

}  // namespace
}  // namespace engram::training
