// SPDX-License-Identifier: Apache-2.0
#include "training/forms/view_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "encoders/deep_model_file.h"
#include "tests/training/moving_scene.h"
#include "training/forms/block_choice.h"
#include "training/quality/psnr.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {
namespace {

using engram::testing::quick_options;
using engram::testing::scene_at;
using engram::testing::scene_source;
using engram::testing::ScratchPath;

/// The moving square, over another ground: stripes where there were shades.
idf::Data elsewhere(int i) {
  idf::Data value = scene_at(i, true, false);
  const auto* image = value.at("image")->get_if<idf::NdArray>();
  const auto pixels = image->values<uint8_t>();
  std::vector<uint8_t> changed(pixels.begin(), pixels.end());
  for (size_t at = 0; at < changed.size(); at += 3) {
    if (changed[at] == 230) continue;
    const bool is_stripe = at / 3 % 48 / 8 % 2 == 0;
    for (size_t c = 0; c < 3; ++c) changed[at + c] = is_stripe ? 200 : 20;
  }
  idf::Dict dict;
  dict.set("image", idf::NdArray::take<uint8_t>(image->shape(), std::move(changed)));
  dict.set("label", "elsewhere");
  return dict;
}

/// A model that was trained briefly on one ground.
std::shared_ptr<encoders::DeepModel> trained_model() {
  const ScratchPath file("view_choice");
  const auto source = scene_source(24, 1, true, false);
  EXPECT_TRUE(train_model(source, quick_options(150), file.path(), {}, {}).ok());
  return *encoders::read_model(file.path());
}

TEST(ViewChoice, TakesABackgroundOfItsOwnWhereTheModelKnowsNone) {
  const auto model = trained_model();
  std::vector<idf::SplitValue> known, unknown;
  for (int i = 4; i < 16; ++i) {
    known.push_back(*model->plan.layout().split(scene_at(i, true, false)));
    unknown.push_back(*model->plan.layout().split(elsewhere(i)));
  }
  const auto at_home = rows_on_best_view(*model, known);
  ASSERT_TRUE(at_home.ok()) << at_home.status().to_string();
  EXPECT_TRUE(at_home->own.empty());

  const auto away = rows_on_best_view(*model, unknown);
  ASSERT_TRUE(away.ok()) << away.status().to_string();
  ASSERT_EQ(away->own.size(), 1u);
  const auto error_of = [&](const encoders::LatentRows& rows) {
    return *grey_mse(unknown[3].tensors[model->plan.images()[0].member],
                     model->decode_images(rows, 3)->front());
  };
  EXPECT_LT(error_of(*away), error_of(*model->to_rows(unknown)) / 2);

  // What a query decodes is the same, from bytes alone.
  const auto chains = encoders::cut_chains(*away, unknown.size(), model->codec.chain_rows);
  const auto decoded =
      model->codec.decode_all(model->codec.encode(chains, unknown.size()), unknown.size());
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  EXPECT_EQ(*model->decode_images(decoded->front(), 3), *model->decode_images(*away, 3));
}

TEST(ViewChoice, PaysForABackgroundOnceInAllChainsOfABlock) {
  const auto model = trained_model();
  model->codec.chain_rows = 8;
  std::vector<idf::Data> values;
  for (int i = 0; i < 24; ++i) values.push_back(elsewhere(i));
  RepresentationOptions latents_alone;
  latents_alone.kind = Representation::kLatents;
  BlockChoice choice(*model, latents_alone);
  std::vector<size_t> done;
  const auto latents = choice.encode(values, {}, [&](size_t rows) -> Status {
    done.push_back(rows);
    return {};
  });
  ASSERT_TRUE(latents.ok()) << latents.status().to_string();
  // While views are tried, then before each chain.
  EXPECT_TRUE(std::ranges::is_sorted(done));
  EXPECT_THAT(done, ::testing::IsSupersetOf({size_t{0}, size_t{8}, size_t{16}}));
  const auto block = encoders::describe_block(latents->front().code.bytes(), 24, 1);
  ASSERT_TRUE(block.ok()) << block.status().to_string();
  EXPECT_EQ(block->chains.size(), 3u);
  const uint64_t background = block->background_bytes[0];
  ASSERT_GT(background, 0u);
  // What the choice counts is what the block holds: chains and, once, the background.
  uint64_t held = background;
  for (const auto& chain : block->chains) held += chain.front().bytes;
  EXPECT_EQ(choice.counts().kept_bytes, static_cast<int64_t>(held));
  EXPECT_EQ(choice.counts().latent_rows, 24);

  // Every row comes back, whichever chain it is of.
  const auto decoded = encoders::make_encoder(model)->decode(*latents);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  for (size_t i = 0; i < values.size(); ++i)
    EXPECT_GT(psnr_db(compare(values[i], (*decoded)[i])->image_mse), 15) << i;

  const auto stopped = choice.encode(values, {}, [](size_t) { return cancelled("enough"); });
  EXPECT_EQ(stopped.status().code(), StatusCode::kCancelled);
}

TEST(ViewChoice, CountsEveryByteOfABlockWhateverIsKept) {
  const auto model = trained_model();
  model->codec.chain_rows = 8;
  std::vector<idf::Data> values;
  for (int i = 0; i < 24; ++i) values.push_back(elsewhere(i));
  const auto kept_at = [&](double bound_db) {
    RepresentationOptions smallest;
    smallest.kind = Representation::kAuto;
    smallest.bound_db = bound_db;
    smallest.video = "none";
    BlockChoice choice(*model, smallest);
    const auto latents = choice.encode(values);
    EXPECT_TRUE(latents.ok()) << latents.status().to_string();
    const auto bytes = latents->front().code.bytes();
    // Beside what is counted: heads and a checksum.
    const auto uncounted = static_cast<int64_t>(bytes.size()) - choice.counts().kept_bytes;
    EXPECT_GT(uncounted, 0) << bound_db;
    EXPECT_LT(uncounted, 64) << bound_db;
    const auto block = encoders::describe_block(bytes, 24, 1);
    EXPECT_TRUE(block.ok()) << block.status().to_string();
    return std::pair(choice.counts(), block->background_bytes[0]);
  };
  const auto [coarse, coarse_background] = kept_at(12);
  EXPECT_GT(coarse.latent_rows, 0);
  EXPECT_GT(coarse_background, 0u);
  const auto [fine, fine_background] = kept_at(kLargestPsnrDb);
  EXPECT_EQ(fine.lossless_rows, 24);
  EXPECT_EQ(fine_background, 0u);
}

}  // namespace
}  // namespace engram::training
