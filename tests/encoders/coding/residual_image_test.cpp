// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/residual_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace engram::encoders {
namespace {

using Pixels = std::vector<uint8_t>;

/// A shaded image with a disc that moves.
Pixels recorded(const PixelShape& shape, int row) {
  Pixels pixels;
  for (int y = 0; y < shape.height; ++y)
    for (int x = 0; x < shape.width; ++x) {
      const bool is_disc = std::hypot(x - 10 - 2 * row, y - shape.height / 2) < 7;
      for (int c = 0; c < shape.channels; ++c)
        pixels.push_back(static_cast<uint8_t>(is_disc ? 200 + 20 * c : 30 + 2 * x + y * (c + 1)));
    }
  return pixels;
}

/// What a network may make of it: without the disc, and with errors of its own.
Pixels decoded(const PixelShape& shape, int row) {
  std::mt19937 random(static_cast<unsigned>(row));
  Pixels pixels;
  for (int y = 0; y < shape.height; ++y)
    for (int x = 0; x < shape.width; ++x)
      for (int c = 0; c < shape.channels; ++c)
        pixels.push_back(static_cast<uint8_t>(31 + 2 * x + y * (c + 1) + random() % 5));
  return pixels;
}

uint64_t squared_error(const Pixels& a, const Pixels& b) {
  uint64_t sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += static_cast<uint64_t>((a[i] - b[i]) * (a[i] - b[i]));
  return sum;
}

/// The sum of squares that a PSNR allows.
uint64_t max_error(const PixelShape& shape, double psnr_db) {
  return static_cast<uint64_t>(255.0 * 255 * std::pow(10, -psnr_db / 10) *
                               static_cast<double>(shape.count()));
}

constexpr size_t kRows = 5;

/// Rows 0, 2 and 3 of five have a residual.
std::vector<std::byte> coded(const PixelShape& shape, double psnr_db) {
  ResidualEncoder encoder(shape);
  for (int row = 0; row < static_cast<int>(kRows); ++row) {
    const bool is_good = row == 1 || row == 4;
    EXPECT_TRUE(encoder.add(is_good ? recorded(shape, row) : decoded(shape, row),
                            recorded(shape, row), max_error(shape, psnr_db)));
  }
  return encoder.finish();
}

const std::vector<PixelShape> kShapes{{48, 64, 3}, {21, 35, 3}, {8, 8, 1}, {40, 17, 1}, {9, 9, 4}};

TEST(ResidualImage, KeepsTheBoundInEveryRowThatHasOne) {
  for (const PixelShape& shape : kShapes)
    for (const double psnr_db : {20.0, 30.0, 38.0, 45.0, 52.0}) {
      const auto rows = decode_residuals(coded(shape, psnr_db), shape, kRows, kRows);
      ASSERT_TRUE(rows.ok()) << rows.status().to_string();
      for (const int row : {0, 2, 3}) {
        Pixels image = decoded(shape, row);
        const auto& residual = (*rows)[static_cast<size_t>(row)];
        if (!residual.empty()) add_residual(residual, shape, image);
        EXPECT_LE(squared_error(image, recorded(shape, row)), max_error(shape, psnr_db))
            << shape.width << " " << psnr_db << " row " << row;
      }
      EXPECT_TRUE((*rows)[1].empty());
      EXPECT_TRUE((*rows)[4].empty());
    }
}

TEST(ResidualImage, TakesMoreBytesTheNarrowerTheBound) {
  const PixelShape shape = kShapes.front();
  size_t before = 0;
  for (const double psnr_db : {20.0, 26.0, 32.0, 38.0, 44.0, 50.0}) {
    const size_t bytes = coded(shape, psnr_db).size();
    EXPECT_GT(bytes, before) << psnr_db;
    before = bytes;
  }
  EXPECT_LT(coded(shape, 32).size(), kRows * shape.count() / 50);
}

TEST(ResidualImage, GoesOnFromWhatTheLastImageLacked) {
  const PixelShape shape = kShapes.front();
  ResidualEncoder encoder(shape);
  for (int row = 0; row < 3; ++row)
    ASSERT_TRUE(encoder.add(decoded(shape, 1), recorded(shape, 1), max_error(shape, 40)));
  const auto bytes = residual_bytes(encoder.finish(), 3);
  ASSERT_TRUE(bytes.ok()) << bytes.status().to_string();
  EXPECT_LT(*(*bytes)[1], *(*bytes)[0] / 10);
  EXPECT_LT(*(*bytes)[2], *(*bytes)[0] / 10);
}

TEST(ResidualImage, DecodesItsFirstRowsAlone) {
  const PixelShape shape = kShapes.front();
  const auto bytes = coded(shape, 40);
  const auto all = decode_residuals(bytes, shape, kRows, kRows);
  const auto first = decode_residuals(bytes, shape, kRows, 3);
  ASSERT_TRUE(all.ok() && first.ok());
  ASSERT_EQ(first->size(), 3u);
  for (size_t row = 0; row < 3; ++row) EXPECT_EQ((*first)[row], (*all)[row]);
}

TEST(ResidualImage, TellsTheBytesOfEachRow) {
  const auto bytes = coded(kShapes.front(), 40);
  const auto each = residual_bytes(bytes, kRows);
  ASSERT_TRUE(each.ok());
  EXPECT_FALSE((*each)[1] || (*each)[4]);
  const uint64_t sum = *(*each)[0] + *(*each)[2] + *(*each)[3];
  EXPECT_LT(sum, bytes.size());
  EXPECT_GE(sum + 3 * kRows, bytes.size());
}

TEST(ResidualImage, IsEmptyWhereNoRowHasOne) {
  ResidualEncoder encoder(kShapes.front());
  const Pixels image = recorded(kShapes.front(), 0);
  EXPECT_TRUE(encoder.add(image, image, 0));
  EXPECT_TRUE(encoder.finish().empty());
}

TEST(ResidualImage, SaysWhereNoStepIsFineEnough) {
  const PixelShape shape = kShapes.front();
  ResidualEncoder encoder(shape);
  EXPECT_FALSE(encoder.add(decoded(shape, 0), recorded(shape, 0), 0));
  EXPECT_TRUE(encoder.finish().empty());
}

TEST(ResidualImage, IsTheSameEveryTime) {
  EXPECT_EQ(coded(kShapes[1], 38), coded(kShapes[1], 38));
  // What was written once must decode to the same for ever.
  std::vector<int16_t> coefficients(BlockGrid({8, 8, 1}).coefficients());
  coefficients[0] = 800;
  coefficients[1] = -320;
  coefficients[9] = 77;
  const auto pixels = from_coefficients(coefficients, {8, 8, 1});
  EXPECT_EQ((std::vector<int16_t>(pixels.begin(), pixels.begin() + 8)),
            (std::vector<int16_t>{7, 8, 10, 13, 15, 18, 20, 21}));
}

TEST(ResidualImage, TransformsBackWhatItTransformed) {
  std::mt19937 random(3);
  for (const PixelShape& shape : kShapes) {
    std::vector<int16_t> differences(shape.count());
    for (int16_t& value : differences) value = static_cast<int16_t>(random() % 511 - 255);
    const auto again = from_coefficients(to_coefficients(differences, shape), shape);
    for (size_t i = 0; i < differences.size(); ++i) ASSERT_NEAR(again[i], differences[i], 1) << i;
  }
}

TEST(ResidualImage, ReadsAnyBytesWithoutHarm) {
  const PixelShape shape{21, 35, 3};
  const auto bytes = coded(shape, 40);
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    auto damaged = bytes;
    for (int i = 0; i < 3; ++i) damaged[random() % damaged.size()] = std::byte(random() % 256);
    if (round % 3 == 0) damaged.resize(random() % damaged.size());
    const auto rows = decode_residuals(damaged, shape, kRows, kRows);
    if (!rows.ok()) {
      EXPECT_EQ(rows.status().code(), StatusCode::kDataLoss);
      continue;
    }
    Pixels image = decoded(shape, 0);
    for (const auto& row : *rows)
      if (!row.empty()) add_residual(row, shape, image);
  }
  EXPECT_EQ(decode_residuals(bytes, shape, kRows + 1, 1).status().code(), StatusCode::kDataLoss);
  EXPECT_EQ(decode_residuals({}, shape, kRows, 1).status().code(), StatusCode::kDataLoss);
}

}  // namespace
}  // namespace engram::encoders
