// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/latent_sequence.h"

#include <gmock/gmock.h>

#include <numeric>
#include <random>

#include "encoders/coding/checked_block.h"
#include "encoders/coding/integer_coder.h"
#include "encoders/coding/logistic.h"
#include "tests/ltm/expect_status.h"

namespace engram::encoders {
namespace {

const std::vector<LatentGrid> kGrids{{3, 2, 4}, {2, 4, 8}};
constexpr size_t kLatents = 3 * 2 * 4 + 2 * 4 * 8;

/// Rows that mostly repeat the one before, as a scene that hardly moves.
std::vector<int32_t> calm(size_t rows, unsigned seed, double change = 0.05) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> chance(0, 1);
  std::geometric_distribution<int> size(0.5);
  std::vector<int32_t> latents(rows * kLatents);
  for (size_t i = 0; i < latents.size(); ++i) {
    const bool is_new = i < kLatents || chance(random) < change;
    latents[i] = is_new ? size(random) * (random() % 2 == 0 ? 1 : -1) : latents[i - kLatents];
  }
  return latents;
}

void expect_round_trip(const LatentSequenceCodec& codec, const std::vector<int32_t>& latents) {
  const size_t rows = latents.size() / codec.model().latents();
  const auto block = codec.encode(latents);
  const auto decoded = codec.decode(block, rows);
  ASSERT_OK(decoded);
  EXPECT_EQ(*decoded, latents);
}

TEST(LatentSequence, GivesBackWhatItWasGiven) {
  const LatentSequenceCodec plain{LatentModel(kGrids)};
  const std::vector<std::vector<int32_t>> lesson{calm(40, 1)};
  const LatentSequenceCodec trained{LatentModel::train(kGrids, lesson)};
  for (const auto* codec : {&plain, &trained}) {
    expect_round_trip(*codec, calm(12, 2));
    expect_round_trip(*codec, calm(5, 3, 1));
    expect_round_trip(*codec, std::vector<int32_t>(kLatents * 7));
    expect_round_trip(*codec, {});
  }
}

TEST(LatentSequence, TakesEveryInteger) {
  std::vector<int32_t> latents(3 * kLatents);
  const std::vector<int32_t> extremes{INT32_MIN, INT32_MAX, -1, 1,     0,
                                      12,        -13,       14, 70000, INT32_MIN};
  for (size_t i = 0; i < latents.size(); ++i) latents[i] = extremes[i * i % extremes.size()];
  expect_round_trip(LatentSequenceCodec{LatentModel(kGrids)}, latents);
}

TEST(LatentSequence, ReadsOnlyTheFirstRowsWhereThatIsEnough) {
  const LatentSequenceCodec codec{LatentModel(kGrids)};
  const auto latents = calm(20, 4);
  const auto block = codec.encode(latents);
  for (const size_t wanted : {0u, 1u, 7u, 20u}) {
    const auto decoded = codec.decode(block, 20, wanted);
    ASSERT_OK(decoded);
    EXPECT_TRUE(std::ranges::equal(*decoded, std::span(latents).first(wanted * kLatents)));
  }
}

TEST(LatentSequence, ItsBytesAreWhatItsProbabilitiesSay) {
  const std::vector<std::vector<int32_t>> lesson{calm(100, 5)};
  const LatentSequenceCodec codec{LatentModel::train(kGrids, lesson)};
  const auto latents = calm(400, 6, 0.2);
  const auto costs = codec.cost_bits(latents);
  ASSERT_EQ(costs.size(), 400u);
  const double ideal = std::accumulate(costs.begin(), costs.end(), 0.0) / 8;
  EXPECT_NEAR(static_cast<double>(codec.encode(latents).size()), ideal, 0.01 * ideal + 8);
}

TEST(LatentSequence, WhatStaysCostsLittleAndWhatWasLearnedLess) {
  const auto latents = calm(60, 7);
  const LatentSequenceCodec plain{LatentModel(kGrids)};
  const std::vector<std::vector<int32_t>> lesson{calm(300, 8)};
  const LatentSequenceCodec trained{LatentModel::train(kGrids, lesson)};
  // Of 88 latents a row about 4 change: where (27 bits) and to what (9 bits) is the least there is.
  EXPECT_LT(trained.encode(latents).size(), 60 * 7u);
  EXPECT_LT(trained.encode(latents).size(), plain.encode(latents).size() * 9 / 10);
  EXPECT_LT(plain.encode(latents).size(), plain.encode(calm(60, 7, 1)).size() / 3);
}

TEST(LatentSequence, FindsDamage) {
  const LatentSequenceCodec codec{LatentModel(kGrids)};
  const auto block = codec.encode(calm(10, 9));
  for (size_t byte = 0; byte < block.size(); ++byte) {
    auto damaged = block;
    damaged[byte] ^= std::byte{4};
    EXPECT_FAILS(codec.decode(damaged, 10), StatusCode::kDataLoss, "block of latents");
  }
  for (size_t bytes = 0; bytes < block.size(); ++bytes)
    EXPECT_FALSE(codec.decode(std::span(block).first(bytes), 10).ok()) << bytes;
  EXPECT_FALSE(codec.decode(block, 11).ok()) << "the number of rows is part of it";
}

TEST(LatentSequence, AnyBytesWithAFittingChecksumGiveSomeLatents) {
  std::mt19937 random(13);
  const LatentSequenceCodec codec{LatentModel(kGrids)};
  for (int round = 0; round < 200; ++round) {
    std::vector<std::byte> bytes(random() % 400);
    for (std::byte& each : bytes) each = std::byte(round % 2 == 0 ? random() : random() % 2 * 255);
    const auto decoded = codec.decode(with_checksum(bytes, 9), 9);
    ASSERT_OK(decoded);
    ASSERT_EQ(decoded->size(), 9 * kLatents);
    EXPECT_EQ(*codec.decode(codec.encode(*decoded), 9), *decoded) << "what is read can be written";
  }
}

/// A block of one row that begins with one latent above the unary part, by the bits that a model
/// which knows nothing asks for. `beyond` is what the integer behind the unary part says.
std::vector<std::byte> hostile_block(bool is_negative, int64_t beyond) {
  // Every context is new: a mixer of eight inputs hears its constant alone.
  const BitProbability one = squash(256 / 4);
  BinaryEncoder encoder;
  encoder.code(false, one);  // Not zero.
  encoder.code(is_negative, one);
  for (int magnitude = 1; magnitude <= 12; ++magnitude) encoder.code(true, one);
  IntegerModel large;
  large.code(encoder, beyond);
  return with_checksum(encoder.finish(), 1);
}

TEST(LatentSequence, ClampsWhateverAHostileBlockSays) {
  const LatentSequenceCodec codec{LatentModel(kGrids)};
  const auto first = [&](bool is_negative, int64_t beyond) -> int32_t {
    const auto row = codec.decode(hostile_block(is_negative, beyond), 1);
    return row.ok() ? row->front() : 0;
  };
  EXPECT_EQ(first(false, 0), 13);
  EXPECT_EQ(first(true, 987), -1000) << "the script speaks the language of blocks";
  EXPECT_EQ(first(false, INT32_MAX - 13), INT32_MAX);
  EXPECT_EQ(first(true, int64_t{INT32_MAX} - 12), INT32_MIN);
  for (const int64_t beyond : {int64_t{INT32_MAX}, int64_t{1} << 40, INT64_MAX, INT64_MAX - 14}) {
    EXPECT_EQ(first(false, beyond), INT32_MAX) << beyond;
    EXPECT_EQ(first(true, beyond), INT32_MIN) << beyond;
  }
  for (const int64_t beyond : {int64_t{-1}, int64_t{-14}, INT64_MIN}) {
    EXPECT_EQ(first(false, beyond), 13) << beyond;
    EXPECT_EQ(first(true, beyond), -13) << beyond;
  }
}

TEST(LatentSequence, ItsModelIsStoredWhole) {
  const std::vector<std::vector<int32_t>> lesson{calm(50, 10), calm(20, 11)};
  const LatentModel model = LatentModel::train(kGrids, lesson);
  const auto bytes = model.to_bytes();
  const auto read = LatentModel::from_bytes(bytes, kGrids);
  ASSERT_OK(read);
  EXPECT_EQ(*read, model);
  EXPECT_LT(LatentModel(kGrids).to_bytes().size(), 600u) << "nothing learned takes hardly any room";
  EXPECT_FAILS(LatentModel::from_bytes(bytes, {{3, 2, 4}}), StatusCode::kDataLoss,
               "model of latents");
  auto damaged = bytes;
  damaged[bytes.size() / 2] ^= std::byte{1};
  EXPECT_FAILS(LatentModel::from_bytes(damaged, kGrids), StatusCode::kDataLoss, "model of latents");
}

TEST(LatentSequence, ItsModelFitsItsGridsAlone) {
  const auto bytes = LatentModel(kGrids).to_bytes();
  // As many contexts as kGrids: only the sizes differ.
  const std::vector<LatentGrid> turned{{3, 4, 2}, {2, 4, 8}};
  EXPECT_FAILS(LatentModel::from_bytes(bytes, turned), StatusCode::kDataLoss, "model of latents");
}

TEST(LatentSequence, NeedsAGrid) {
  EXPECT_DEATH(LatentModel({}), "no grids");
}

TEST(LatentSequence, EqualLatentsGiveEqualBytes) {
  const LatentSequenceCodec codec{LatentModel(kGrids)};
  EXPECT_EQ(codec.encode(calm(10, 12)), codec.encode(calm(10, 12)));
  std::vector<int32_t> golden(2 * kLatents);
  for (size_t i = 0; i < golden.size(); ++i)
    golden[i] = i % 5 == 0 ? static_cast<int32_t>(i % 7) - 3 : 0;
  uint64_t hash = 1469598103934665603u;
  for (const std::byte byte : codec.encode(golden))
    hash = (hash ^ std::to_integer<uint64_t>(byte)) * 1099511628211u;
  EXPECT_EQ(hash, 1095120782094651183u) << "stored blocks must go on decoding: bytes never change";
}

}  // namespace
}  // namespace engram::encoders
