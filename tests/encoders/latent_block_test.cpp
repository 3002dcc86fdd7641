// SPDX-License-Identifier: Apache-2.0
#include "encoders/latent_block.h"

#include <gtest/gtest.h>

#include <random>

#include "encoders/coding/checked_block.h"
#include "ltm/codec/group_codec.h"

namespace engram::encoders {
namespace {

constexpr size_t kRows = 6;

LatentBlockCodec codec() {
  LatentBlockCodec codec;
  const std::vector<LatentGrid> grids{{3, 2, 2}, {2, 4, 4}};
  codec.chain.images.emplace_back(LatentModel(grids));
  codec.chain.images.emplace_back(LatentModel(grids));
  codec.chain.numbers.emplace(*NumberModel::create({{NumberKind::kBounded, 2, 0.01}}));
  codec.chain.frames.assign(2, {idf::ElementType::kUInt8, {64, 64, 3}});
  codec.scenes = 3;
  return codec;
}

/// As a block of one chain.
std::vector<std::byte> encode(const LatentRows& rows) {
  return codec().encode({&rows, 1}, kRows);
}

/// The first rows of the first chain.
Result<LatentRows> decode(std::span<const std::byte> block, size_t wanted, size_t count = kRows) {
  const LatentBlockCodec decoder = codec();
  ENGRAM_ASSIGN_OR_RETURN(const OpenBlock open, decoder.open(block, count));
  return decoder.decode(open, 0, wanted);
}

LatentRows some_rows() {
  std::mt19937 random(7);
  LatentRows rows;
  rows.scene = 2;
  for (int image = 0; image < 2; ++image) {
    auto& integers = rows.images.emplace_back().latents;
    for (size_t i = 0; i < kRows * (3 * 4 + 2 * 16); ++i)
      integers.push_back(static_cast<int32_t>(random() % 7) - 3);
  }
  for (size_t i = 0; i < kRows * 2; ++i) rows.numbers.push_back(0.37 * static_cast<double>(i));
  return rows;
}

TEST(LatentBlock, GivesBackWhatItWasGiven) {
  const LatentRows rows = some_rows();
  const auto block = encode(rows);
  const auto decoded = decode(block, kRows);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  EXPECT_EQ(decoded->scene, 2u);
  EXPECT_EQ(decoded->images, rows.images);
  ASSERT_EQ(decoded->numbers.size(), rows.numbers.size());
  for (size_t i = 0; i < rows.numbers.size(); ++i)
    EXPECT_NEAR(decoded->numbers[i], rows.numbers[i], 0.01);
}

TEST(LatentBlock, DecodesOnlyTheRowsThatAreWanted) {
  const LatentRows rows = some_rows();
  const auto block = encode(rows);
  const auto decoded = decode(block, 2);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  ASSERT_EQ(decoded->images[1].latents.size(), 2u * (3 * 4 + 2 * 16));
  EXPECT_TRUE(std::equal(decoded->images[1].latents.begin(), decoded->images[1].latents.end(),
                         rows.images[1].latents.begin()));
  EXPECT_EQ(decoded->numbers.size(), 4u);
}

TEST(LatentBlock, HoldsVideosInsteadOfLatents) {
  std::vector<idf::NdArray> images;
  for (size_t row = 0; row < kRows; ++row)
    images.push_back(idf::NdArray::take<uint8_t>(
        {64, 64, 3}, std::vector<uint8_t>(64 * 64 * 3, static_cast<uint8_t>(row * 9))));
  LatentRows rows = some_rows();
  rows.images[1].latents.clear();
  rows.images[1].form = *form_of_codec("ffv1");
  rows.images[1].video = *(*ltm::make_group_codec("ffv1"))->encode(images);
  const auto decoded = decode(encode(rows), 3);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  EXPECT_EQ(decoded->images[1].form, ImageForm::kFfv1);
  // What is not wanted is not decoded.
  EXPECT_EQ(decoded->images[1].frames,
            std::vector<idf::NdArray>(images.begin(), images.begin() + 3));
  EXPECT_EQ(decoded->images[0].latents.size(), 3u * (3 * 4 + 2 * 16));
  EXPECT_FALSE(form_of_codec("png").has_value());
}

/// Rows on backgrounds of their own: a shaded one and an even one.
LatentRows rows_with_backgrounds() {
  std::vector<uint8_t> shades(64 * 64 * 3);
  for (size_t i = 0; i < shades.size(); ++i) shades[i] = static_cast<uint8_t>(i / 64 + i % 3 * 10);
  LatentRows rows = some_rows();
  for (auto& pixels : {shades, std::vector<uint8_t>(64 * 64 * 3, 90)})
    rows.own.push_back(**code_background(idf::NdArray::take<uint8_t>({64, 64, 3}, pixels), 0));
  return rows;
}

TEST(LatentBlock, HoldsBackgroundsOfItsOwn) {
  const LatentRows rows = rows_with_backgrounds();
  const auto decoded = decode(encode(rows), kRows);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  EXPECT_EQ(decoded->own, rows.own);
  EXPECT_EQ(decoded->scene, rows.scene);
  EXPECT_EQ(decoded->images, rows.images);
}

/// The codec, but for chains of so many rows.
LatentBlockCodec codec_of_chains(size_t rows) {
  LatentBlockCodec short_chains = codec();
  short_chains.chain_rows = rows;
  return short_chains;
}

TEST(LatentBlock, ReachesAChainWithoutThoseBeforeIt) {
  const LatentRows rows = rows_with_backgrounds();
  const LatentBlockCodec in_fours = codec_of_chains(4);
  const auto block = in_fours.encode(cut_chains(rows, kRows, 4), kRows);
  const auto open = in_fours.open(block, kRows);
  ASSERT_TRUE(open.ok()) << open.status().to_string();
  ASSERT_EQ(open->chains.size(), 2u);
  EXPECT_EQ(open->rows_of(1), 2u);
  const auto last = in_fours.decode(*open, 1, 2);
  ASSERT_TRUE(last.ok()) << last.status().to_string();
  EXPECT_EQ(last->own, rows.own);
  EXPECT_EQ(last->scene, rows.scene);
  for (size_t image = 0; image < 2; ++image) {
    const auto& all = rows.images[image].latents;
    const std::vector<int32_t> end(all.begin() + 4 * (3 * 4 + 2 * 16), all.end());
    EXPECT_EQ(last->images[image].latents, end);
  }
  EXPECT_NEAR(last->numbers[3], rows.numbers.back(), 0.01);
  // Shorter chains take more bytes, backgrounds are there once.
  const auto in_ones = codec_of_chains(1);
  const auto longer = in_ones.encode(cut_chains(rows, kRows, 1), kRows);
  EXPECT_GT(longer.size(), block.size());
  EXPECT_LT(longer.size(), block.size() + rows.own[0].bytes.size() + 4 * 80);
  const auto chains = in_ones.decode_all(longer, kRows);
  ASSERT_TRUE(chains.ok()) << chains.status().to_string();
  EXPECT_EQ(chains->size(), kRows);
}

TEST(LatentBlock, ReadsChainsOfAnyLengthWhateverItsOwnIs) {
  const LatentRows rows = some_rows();
  const auto block = codec_of_chains(4).encode(cut_chains(rows, kRows, 4), kRows);
  const auto chains = codec().decode_all(block, kRows);
  ASSERT_TRUE(chains.ok()) << chains.status().to_string();
  EXPECT_EQ(chains->size(), 2u);
}

TEST(LatentBlock, RefusesABackgroundThatIsNone) {
  LatentRows rows = rows_with_backgrounds();
  rows.own[1].bytes.assign(40, std::byte{0x5a});
  EXPECT_EQ(decode(encode(rows), kRows).status().code(), StatusCode::kDataLoss);
  rows.own[1].form = ImageForm::kLatents;
  EXPECT_EQ(decode(encode(rows), kRows).status().code(), StatusCode::kDataLoss);
}

/// An image that is brighter at one place, and how a network may see it.
std::vector<uint8_t> pixels(size_t row, bool is_decoded) {
  std::vector<uint8_t> values(64 * 64 * 3, static_cast<uint8_t>(90 + row));
  if (!is_decoded) std::fill_n(values.begin() + 64 * 3 * 10, 60, uint8_t{180});
  return values;
}

/// Rows whose second image member was refined; its rows 1 and 4 have residuals.
LatentRows corrected_rows() {
  LatentRows rows = some_rows();
  ResidualEncoder residual({64, 64, 3});
  for (size_t row = 0; row < kRows; ++row) {
    const bool is_bad = row == 1 || row == 4;
    EXPECT_TRUE(residual.add(pixels(row, is_bad), pixels(row, false), 64 * 64));
  }
  rows.images[1].is_refined = true;
  rows.images[1].residual = residual.finish();
  return rows;
}

TEST(LatentBlock, HoldsResidualsOfTheRowsThatNeedThem) {
  const LatentRows rows = corrected_rows();
  const auto block = encode(rows);
  for (const size_t wanted : {size_t{2}, kRows}) {
    const auto decoded = decode(block, wanted);
    ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
    EXPECT_EQ(decoded->images[0].residuals.size(), 0u);
    EXPECT_FALSE(decoded->images[0].is_refined);
    EXPECT_TRUE(decoded->images[1].is_refined);
    ASSERT_EQ(decoded->images[1].residuals.size(), wanted);
    for (size_t row = 0; row < wanted; ++row)
      EXPECT_EQ(decoded->images[1].residuals[row].empty(), row != 1 && row != 4) << row;
    auto image = pixels(1, true);
    add_residual(decoded->images[1].residuals[1], {64, 64, 3}, image);
    EXPECT_NEAR(image[64 * 3 * 10 + 30], 180, 12);
  }
}

/// The rows, with a video in place of the latents of one member, and the residuals that were
/// theirs.
LatentRows rows_with_corrected_video(std::string_view codec) {
  LatentRows rows = corrected_rows();
  std::vector<idf::NdArray> images;
  for (size_t row = 0; row < kRows; ++row)
    images.push_back(idf::NdArray::take<uint8_t>({64, 64, 3}, pixels(row, false)));
  rows.images[1].latents.clear();
  rows.images[1].is_refined = false;
  rows.images[1].form = *form_of_codec(codec);
  rows.images[1].video = *(*ltm::make_group_codec(codec))->encode(images);
  return rows;
}

TEST(LatentBlock, HoldsResidualsOfAVideo) {
  const LatentRows rows = rows_with_corrected_video("h264");
  const auto block = encode(rows);
  const auto decoded = decode(block, kRows);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  EXPECT_EQ(decoded->images[1].form, ImageForm::kH264);
  EXPECT_EQ(decoded->images[1].frames.size(), kRows);
  ASSERT_EQ(decoded->images[1].residuals.size(), kRows);
  for (size_t row = 0; row < kRows; ++row)
    EXPECT_EQ(decoded->images[1].residuals[row].empty(), row != 1 && row != 4) << row;
  const auto says = describe_block(block, kRows, 2);
  ASSERT_TRUE(says.ok()) << says.status().to_string();
  const ImageCode& code = says->chains.front()[1];
  EXPECT_EQ(code.form, ImageForm::kH264);
  EXPECT_EQ(code.bytes, rows.images[1].video.size());
  EXPECT_TRUE(std::ranges::equal(code.residual, rows.images[1].residual));
}

TEST(LatentBlock, RefusesResidualsWithoutLossAndRefinedVideos) {
  constexpr size_t kChainHead = 4;
  const auto h264 = encode(rows_with_corrected_video("h264"));
  const auto body = *without_checksum(h264, "block", kRows);
  // The head of the second member follows the form and size of the first.
  const auto form =
      std::ranges::find(body.begin() + kChainHead + 1, body.end(), std::byte{2 * (16 + 1)});
  ASSERT_NE(form, body.end());
  for (const int wrong : {16 + 4, 8 + 1, 16 + 8 + 1, 16 + 5}) {
    std::vector<std::byte> other(body.begin(), body.end());
    other[static_cast<size_t>(form - body.begin())] = std::byte(static_cast<uint8_t>(2 * wrong));
    const auto decoded = decode(with_checksum(other, kRows), kRows);
    ASSERT_FALSE(decoded.ok()) << wrong;
    EXPECT_NE(decoded.status().message().find("found form"), std::string::npos)
        << decoded.status().message();
  }
}

TEST(LatentBlock, SaysHowEachImageMemberIsKept) {
  const LatentRows rows = corrected_rows();
  const auto block = encode(rows);
  const auto block_says = describe_block(block, kRows, 2);
  ASSERT_TRUE(block_says.ok()) << block_says.status().to_string();
  EXPECT_EQ(block_says->chain_rows, 16u);
  ASSERT_EQ(block_says->chains.size(), 1u);
  const auto& codes = block_says->chains.front();
  ASSERT_EQ(codes.size(), 2u);
  EXPECT_EQ(codes[0].form, ImageForm::kLatents);
  EXPECT_FALSE(codes[0].is_refined);
  EXPECT_EQ(codes[0].bytes, codec().chain.images[0].encode(rows.images[0].latents).size());
  EXPECT_TRUE(codes[0].residual_bytes.empty());
  EXPECT_TRUE(codes[1].is_refined);
  ASSERT_EQ(codes[1].residual_bytes.size(), kRows);
  for (size_t row = 0; row < kRows; ++row)
    EXPECT_EQ(codes[1].residual_bytes[row].has_value(), row == 1 || row == 4) << row;
}

TEST(LatentBlock, RefusesFormsThatThereAreNot) {
  // Behind scene, rows of a chain and the size of the chain, which is below 8192: varints.
  constexpr size_t kChainHead = 4;
  const auto block = encode(some_rows());
  const auto body = *without_checksum(block, "block", kRows);
  for (int form = 0; form < 64; ++form) {
    std::vector<std::byte> other(body.begin(), body.end());
    other[kChainHead] = std::byte(static_cast<uint8_t>(2 * form));
    const auto decoded = decode(with_checksum(other, kRows), kRows);
    EXPECT_EQ(decoded.ok(), form == 0 || form == 8) << form;
  }
}

TEST(LatentBlock, ReadsAnyBytesBehindAFittingChecksum) {
  const auto block = encode(corrected_rows());
  const auto body = *without_checksum(block, "block", kRows);
  std::mt19937 random(11);
  for (int round = 0; round < 400; ++round) {
    std::vector<std::byte> other(body.begin(), body.end());
    for (int i = 0; i < 2; ++i)
      other[random() % (i == 0 ? 12 : other.size())] = std::byte(random());
    other.resize(round % 2 == 0 ? other.size() : random() % other.size());
    const auto sealed = with_checksum(other, kRows);
    const auto decoded = decode(sealed, kRows);
    if (!decoded.ok()) {
      EXPECT_EQ(decoded.status().code(), StatusCode::kDataLoss);
    }
    const auto described = describe_block(sealed, kRows, 2);
    EXPECT_TRUE(described.ok() || !decoded.ok());
  }
}

TEST(LatentBlock, RefusesCountsThatNoBlockHas) {
  const auto block = encode(some_rows());
  const auto body = *without_checksum(block, "block", kRows);
  for (const size_t count : {size_t{0}, kMaxBlockRows + 1, size_t{1} << 32}) {
    const auto sealed = with_checksum({body.begin(), body.end()}, count);
    const auto opened = codec().open(sealed, count);
    EXPECT_EQ(opened.status().code(), StatusCode::kDataLoss) << count;
    EXPECT_NE(opened.status().message().find("needs 1 to 1024"), std::string::npos)
        << opened.status().to_string();
    EXPECT_EQ(describe_block(sealed, count, 2).status().code(), StatusCode::kDataLoss) << count;
  }
}

TEST(LatentBlock, FindsEveryFlippedBitAndEveryMissingByte) {
  const auto block = encode(corrected_rows());
  for (size_t bit = 0; bit < block.size() * 8; ++bit) {
    auto damaged = block;
    damaged[bit / 8] ^= std::byte(1 << (bit % 8));
    EXPECT_EQ(decode(damaged, kRows).status().code(), StatusCode::kDataLoss) << bit;
  }
  for (size_t size = 0; size < block.size(); ++size)
    EXPECT_FALSE(decode(std::span(block).first(size), kRows).ok()) << size;
  EXPECT_FALSE(decode(block, kRows, kRows + 1).ok());
}

}  // namespace
}  // namespace engram::encoders
