// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/number_codec.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "encoders/coding/checked_block.h"
#include "encoders/coding/number_training.h"
#include "encoders/coding/orientation.h"
#include "ltm/core/check.h"

namespace engram::encoders {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Joints that swing, the second half following the first one row later.
std::vector<double> arm(size_t rows, size_t joints, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<double> result;
  const auto angle = [](double t, size_t joint) {
    return std::sin(t * 0.05 * (1.0 + static_cast<double>(joint))) + 0.2 * std::sin(t * 0.31);
  };
  for (size_t t = 0; t < rows; ++t)
    for (size_t j = 0; j < joints; ++j) {
      const double noise = 0.001 * (static_cast<double>(random() % 1000) / 1000 - 0.5);
      const size_t half = joints / 2;
      result.push_back(noise + (j < half ? angle(static_cast<double>(t) + seed, j)
                                         : angle(static_cast<double>(t) + seed - 1, j - half)));
    }
  return result;
}

NumberCodec plain_codec(std::vector<NumberField> fields) {
  auto model = NumberModel::create(std::move(fields));
  ENGRAM_CHECK(model.ok(), "{}", model.status().to_string());
  return NumberCodec(std::move(model).value());
}

NumberCodec trained_codec(std::vector<NumberField> fields,
                          const std::vector<std::vector<double>>& recordings,
                          const NumberTraining& options = {}) {
  auto model = train_number_model(std::move(fields), recordings, options);
  ENGRAM_CHECK(model.ok(), "{}", model.status().to_string());
  return NumberCodec(std::move(model).value());
}

std::vector<double> round_trip(const NumberCodec& codec, const std::vector<double>& rows) {
  const auto block = codec.encode(rows);
  EXPECT_EQ(codec.encode(rows), block);
  const auto decoded = codec.decode(block, rows.size() / codec.model().count());
  EXPECT_TRUE(decoded.ok()) << decoded.status().to_string();
  return decoded.value_or({});
}

/// The same bits, or not more than `bound` apart.
void expect_near(const std::vector<double>& found, const std::vector<double>& rows, double bound) {
  ASSERT_EQ(found.size(), rows.size());
  for (size_t i = 0; i < rows.size(); ++i)
    if (std::bit_cast<uint64_t>(found[i]) != std::bit_cast<uint64_t>(rows[i])) {
      ASSERT_LE(std::abs(found[i] - rows[i]), bound) << "number " << i;
    }
}

TEST(NumberCodec, KeepsEveryNumberWithinItsBound) {
  for (const double bound : {1e-6, 1e-3, 0.1, 10.0})
    for (const size_t rows : {0, 1, 2, 3, 4, 100}) {
      const auto codec = plain_codec({{NumberKind::kBounded, 6, bound}});
      const auto recording = arm(rows, 6, 1);
      expect_near(round_trip(codec, recording), recording, bound);
    }
}

TEST(NumberCodec, KeepsHostileNumbersBitByBit) {
  const double nan = std::nan(""), tiny = std::numeric_limits<double>::denorm_min();
  const std::vector<double> rows{0.5,   nan,  1e300, 1.0,   -kInfinity, -1e300, kInfinity, tiny,
                                 -1e18, 0.25, -0.0,  -tiny, nan,        1e9,    2.0,       -nan};
  const auto codec = plain_codec({{NumberKind::kBounded, 2, 1e-3}});
  const auto found = round_trip(codec, rows);
  expect_near(found, rows, 1e-3);
  EXPECT_TRUE(std::isnan(found[1]));
  EXPECT_EQ(found[2], 1e300);
  EXPECT_EQ(found[4], -kInfinity);
}

TEST(NumberCodec, KeepsRandomBitsWithinTheBoundOrExactly) {
  std::mt19937_64 random(4);
  std::vector<double> rows;
  for (int i = 0; i < 3000; ++i) rows.push_back(std::bit_cast<double>(random()));
  expect_near(round_trip(plain_codec({{NumberKind::kBounded, 3, 1e-3}}), rows), rows, 1e-3);
  const auto exact = round_trip(plain_codec({{NumberKind::kExact, 3}}), rows);
  expect_near(exact, rows, -1);
}

TEST(NumberCodec, KeepsExactNumbersExactly) {
  std::vector<double> rows;
  for (int i = 0; i < 400; ++i) {
    rows.push_back(i % 2);
    rows.push_back(i / 100.0);
    rows.push_back(std::sqrt(i));
  }
  const auto codec = trained_codec({{NumberKind::kExact, 3}}, {rows});
  EXPECT_EQ(codec.model().channels[0].decimals, 0);
  EXPECT_EQ(codec.model().channels[1].decimals, 2);
  expect_near(round_trip(codec, rows), rows, -1);
}

TEST(NumberCodec, KeepsTheSignOfAnExactZero) {
  const std::vector<double> rows{0.0, -0.0, -0.0, 1.0, -0.0, 0.0, 0.25, -0.0};
  expect_near(round_trip(plain_codec({{NumberKind::kExact, 1}}), rows), rows, -1);
  expect_near(round_trip(trained_codec({{NumberKind::kExact, 1}}, {rows}), rows), rows, -1);
}

TEST(NumberCodec, KeepsExactNumbersThatJump) {
  std::vector<double> rows;
  for (const double size : {1.0, 1e3, 1e9, 549755813888.0, 549755813889.0, 1e12, 1e18})
    for (int i = 0; i < 6; ++i) rows.push_back(i % 2 == 0 ? size : -size);
  const auto codec = trained_codec({{NumberKind::kExact, 1}}, {rows});
  expect_near(round_trip(codec, rows), rows, -1);
  expect_near(round_trip(plain_codec({{NumberKind::kExact, 1}}), rows), rows, -1);
}

std::vector<double> as_floats(std::vector<double> rows) {
  for (double& value : rows) value = static_cast<double>(static_cast<float>(value));
  return rows;
}

TEST(NumberCodec, KeepsEveryBitOfFloats) {
  std::mt19937 random(6);
  std::vector<double> rows;
  for (int i = 0; i < 3002; ++i) {
    // Reading a signalling NaN makes it a quiet one.
    const auto value = std::bit_cast<float>(static_cast<uint32_t>(random()));
    rows.push_back(std::isnan(value) ? std::nan("") : static_cast<double>(value));
  }
  using Limits = std::numeric_limits<float>;
  for (const double special : {0.0, -0.0, kInfinity, -kInfinity, double{Limits::denorm_min()},
                               double{Limits::max()}, double{Limits::lowest()}})
    rows.insert(rows.begin() + 7, special);
  const std::vector<NumberField> fields{{NumberKind::kExactFloat, 3}};
  expect_near(round_trip(plain_codec(fields), rows), rows, -1);
  expect_near(round_trip(trained_codec(fields, {rows}), rows), rows, -1);
}

TEST(NumberCodec, FindsWhatFloatsHaveInCommon) {
  std::vector<double> rows;
  for (int i = 0; i < 400; ++i) {
    rows.push_back(0.001 * std::round(200 * std::sin(0.1 * i)));
    rows.push_back(std::sin(0.05 * i) + 2);
  }
  rows = as_floats(std::move(rows));
  const auto codec = trained_codec({{NumberKind::kExactFloat, 2}}, {rows});
  EXPECT_EQ(codec.model().channels[0].decimals, 3);
  EXPECT_EQ(codec.model().channels[1].decimals, NumberChannel::kAsOrdered);
  expect_near(round_trip(codec, rows), rows, -1);
  const auto doubles = trained_codec({{NumberKind::kExact, 2}}, {rows});
  EXPECT_LT(codec.encode(rows).size() * 2, doubles.encode(rows).size());
}

TEST(NumberCodec, KeepsFloatsThatAreNoDecimalsAmongThoseThatAre) {
  std::vector<double> rows;
  for (int i = 0; i < 200; ++i) rows.push_back(i == 70 ? 0.1234567 : i == 90 ? -kInfinity : i / 8.);
  rows = as_floats(std::move(rows));
  const auto codec = trained_codec({{NumberKind::kExactFloat, 1}}, {rows});
  EXPECT_EQ(codec.model().channels[0].decimals, 3);
  expect_near(round_trip(codec, rows), rows, -1);
}

TEST(NumberCodec, TakesFewBytesWhereNumbersFollowEachOther) {
  const std::vector<std::vector<double>> recordings{arm(400, 6, 3), arm(400, 6, 50)};
  const std::vector<NumberField> fields{{NumberKind::kBounded, 6, 1e-3}};
  const auto unseen = arm(400, 6, 90);
  const size_t plain = plain_codec(fields).encode(unseen).size();
  const auto codec = trained_codec(fields, recordings);
  EXPECT_LT(static_cast<double>(codec.encode(unseen).size()), 0.5 * static_cast<double>(plain));
  EXPECT_LT(codec.model().to_bytes().size(), 3000u);
  expect_near(round_trip(codec, unseen), unseen, 1e-3);
}

TEST(NumberCodec, DecodesABlockAlone) {
  const auto recording = arm(90, 4, 5);
  const auto codec =
      trained_codec({{NumberKind::kBounded, 4, 1e-3}}, {recording}, {.block_rows = 30});
  const std::vector<double> middle(recording.begin() + 120, recording.begin() + 240);
  expect_near(round_trip(codec, middle), middle, 1e-3);
}

std::vector<double> turning(size_t rows, double step_rad) {
  std::vector<double> result;
  for (size_t t = 0; t < rows; ++t) {
    const double half = step_rad * static_cast<double>(t) / 2, sign = t % 3 == 0 ? -1 : 1;
    for (const double part : {std::cos(half), 0.6 * std::sin(half), 0.0, 0.8 * std::sin(half)})
      result.push_back(sign * part);
  }
  return result;
}

void expect_turned_less(const std::vector<double>& found, const std::vector<double>& rows,
                        double bound_rad) {
  ASSERT_EQ(found.size(), rows.size());
  for (size_t i = 0; i < rows.size(); i += 4) {
    const Quaternion q{found[i], found[i + 1], found[i + 2], found[i + 3]};
    const Quaternion r{rows[i], rows[i + 1], rows[i + 2], rows[i + 3]};
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-14);
    EXPECT_GT(q[0] * r[0] + q[1] * r[1] + q[2] * r[2] + q[3] * r[3], 0) << "turned over";
    EXPECT_LE(angle_between_rad(q, r), bound_rad);
  }
}

TEST(NumberCodec, KeepsOrientationsWithinTheirAngle) {
  for (const double bound_rad : {1e-6, 1e-3, 0.5})
    for (const double step_rad : {0.001, 0.3, 3.1415926, 2.0}) {
      const auto rows = turning(200, step_rad);
      const auto codec = plain_codec({{NumberKind::kOrientation, 4, bound_rad}});
      expect_turned_less(round_trip(codec, rows), rows, bound_rad);
    }
}

TEST(NumberCodec, GoesOnTurning) {
  const auto rows = turning(200, 0.1);
  const std::vector<NumberField> fields{{NumberKind::kOrientation, 4, 1e-3}};
  const auto codec = trained_codec(fields, {rows});
  EXPECT_GT(codec.model().channels[0].eighths, 4);
  EXPECT_LT(codec.encode(rows).size() * 2, plain_codec(fields).encode(rows).size());
  expect_turned_less(round_trip(codec, rows), rows, 1e-3);
}

TEST(NumberCodec, KeepsWhatIsNoOrientationAsItIs) {
  std::vector<double> rows = turning(20, 0.1);
  std::ranges::fill(rows.begin() + 8, rows.begin() + 12, 0.0);
  rows[20] = std::nan("");
  rows[32] = 5;
  const auto found = round_trip(plain_codec({{NumberKind::kOrientation, 4, 1e-3}}), rows);
  for (const size_t i : {8u, 9u, 10u, 11u, 21u, 32u, 33u}) EXPECT_EQ(found[i], rows[i]) << i;
  EXPECT_TRUE(std::isnan(found[20]));
}

TEST(NumberCodec, MixesFields) {
  std::vector<double> rows;
  for (size_t t = 0; t < 60; ++t) {
    const double x = 0.1 * static_cast<double>(t);
    for (const double value :
         {x, std::cos(x), std::sin(x), 0.0, 0.0, static_cast<double>(t), x * x})
      rows.push_back(value);
  }
  const auto codec = trained_codec({{NumberKind::kBounded, 1, 0.01},
                                    {NumberKind::kOrientation, 4, 0.02},
                                    {NumberKind::kExact, 1},
                                    {NumberKind::kBounded, 1, 0.5}},
                                   {rows});
  const auto found = round_trip(codec, rows);
  for (size_t at = 0; at < rows.size(); at += 7) {
    EXPECT_LE(std::abs(found[at] - rows[at]), 0.01);
    EXPECT_EQ(found[at + 5], rows[at + 5]);
    EXPECT_LE(std::abs(found[at + 6] - rows[at + 6]), 0.5);
  }
}

TEST(NumberCodec, FindsDamageTruncationAndAnotherNumberOfRows) {
  const auto codec = plain_codec({{NumberKind::kBounded, 4, 1e-3}});
  const auto block = codec.encode(arm(10, 4, 2));
  for (size_t i = 0; i < block.size(); ++i) {
    auto damaged = block;
    damaged[i] ^= std::byte{0x20};
    EXPECT_EQ(codec.decode(damaged, 10).status().code(), StatusCode::kDataLoss) << i;
    EXPECT_FALSE(codec.decode(std::span(block).first(i), 10).ok()) << i;
  }
  EXPECT_FALSE(codec.decode(block, 9).ok());
  EXPECT_FALSE(codec.decode(block, 11).ok());
  EXPECT_FALSE(codec.decode(block, SIZE_MAX).ok());
}

TEST(NumberModel, IsTheSameAfterItsBytes) {
  const auto codec = trained_codec({{NumberKind::kBounded, 6, 1e-3}}, {arm(200, 6, 3)});
  const auto again = NumberModel::from_bytes(codec.model().to_bytes());
  ASSERT_TRUE(again.ok()) << again.status().to_string();
  EXPECT_EQ(*again, codec.model());
}

TEST(NumberModel, SurvivesAnyBytesBehindAFittingChecksum) {
  const auto good = trained_codec({{NumberKind::kBounded, 2, 1e-3},
                                   {NumberKind::kOrientation, 4},
                                   {NumberKind::kExactFloat, 1}},
                                  {std::vector<double>(70, 0.5)})
                        .model()
                        .to_bytes();
  std::mt19937 random(8);
  size_t read = 0;
  for (int run = 0; run < 2000; ++run) {
    std::vector<std::byte> bytes(good.begin(), good.end() - 4);
    for (int i = 0; i < 3; ++i) bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    if (run % 5 == 0) bytes.resize(random() % bytes.size());
    const auto model = NumberModel::from_bytes(with_checksum(bytes));
    if (!model.ok()) continue;
    ++read;
    const NumberCodec codec(*model);
    if (codec.model().count() == 0) continue;
    std::vector<std::byte> block(random() % 60);
    for (std::byte& byte : block) byte = static_cast<std::byte>(random());
    EXPECT_TRUE(codec.decode(with_checksum(block, 20), 20).ok());
  }
  EXPECT_GT(read, 100u);
}

TEST(NumberModel, FindsDamage) {
  auto bytes = plain_codec({{NumberKind::kBounded, 3, 1e-3}}).model().to_bytes();
  bytes[5] ^= std::byte{1};
  EXPECT_EQ(NumberModel::from_bytes(bytes).status().code(), StatusCode::kDataLoss);
}

TEST(NumberModel, RefusesFieldsThatCannotBe) {
  for (const NumberField& field : std::vector<NumberField>{{NumberKind::kBounded, 3, 0.0},
                                                           {NumberKind::kBounded, 3, std::nan("")},
                                                           {NumberKind::kBounded, 0, 1.0},
                                                           {NumberKind::kBounded, 5000, 1.0},
                                                           {NumberKind::kOrientation, 3, 0.1},
                                                           {NumberKind::kOrientation, 4, 2.0}})
    EXPECT_EQ(NumberModel::create({field}).status().code(), StatusCode::kInvalidArgument);
}

TEST(NumberModel, FieldsFollowTheLayout) {
  idf::Dict dict;
  dict.set("gripper", 0.5);
  dict.set("count", int64_t{3});
  dict.set("joints", idf::NdArray::take<double>({7}, std::vector<double>(7)));
  const auto fields = number_fields(idf::Layout::of(idf::Data(dict)), 1e-3, 1e-2);
  const std::vector<NumberField> wanted{{NumberKind::kBounded, 1, 1e-3},
                                        {NumberKind::kExact, 1, 1e-3},
                                        {NumberKind::kBounded, 7, 1e-3}};
  EXPECT_EQ(fields, wanted);
}

TEST(NumberTraining, RefusesRecordingsOfAnotherSize) {
  EXPECT_EQ(train_number_model({{NumberKind::kBounded, 4, 1e-3}},
                               std::vector<std::vector<double>>{std::vector<double>(7)}, {})
                .status()
                .code(),
            StatusCode::kInvalidArgument);
}

TEST(NumberTraining, TakesAnEmptyRecordingBesideALongOne) {
  const std::vector<std::vector<double>> recordings{{}, arm(40, 4, 6)};
  const auto codec = trained_codec({{NumberKind::kBounded, 4, 1e-3}}, recordings, {.max_rows = 9});
  expect_near(round_trip(codec, recordings[1]), recordings[1], 1e-3);
}

TEST(NumberCodec, WritesTheSameBytesOnEveryMachine) {
  std::vector<double> rows;
  for (int t = 0; t < 12; ++t)
    for (const double value : {0.125 * t, 3.0 - 0.0625 * t * t, 0.6, 0.8, 0.0, 0.0})
      rows.push_back(value);
  const auto codec =
      plain_codec({{NumberKind::kBounded, 2, 0.01}, {NumberKind::kOrientation, 4, 0.01}});
  std::string text;
  for (const std::byte byte : codec.encode(rows))
    text += fmt::format("{:02x}", static_cast<int>(byte));
  EXPECT_EQ(text, "099c5be8f6cab57fb47958b026cc67f8f11faede64c8226f90fb3ba996c0613297d1");
}

}  // namespace
}  // namespace engram::encoders
