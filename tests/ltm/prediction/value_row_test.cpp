// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/value_row.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/ltm/print_values.h"

namespace engram::ltm {
namespace {

using idf::Data;
using idf::Dict;
using idf::ElementType;
using idf::NdArray;
using idf::Type;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<double> row_of(const ValueRow& rows, const Data& value,
                           std::span<const double> before = {}) {
  std::vector<double> row(rows.numbers());
  EXPECT_TRUE(rows.read(*rows.layout().split(value), before, row));
  return row;
}

/// What `predicted` makes of `value`.
Data predicted_from(const ValueRow& rows, const Data& value, std::vector<double> predicted) {
  const std::vector<double> last = row_of(rows, value);
  rows.finish(last, predicted);
  return rows.value(*rows.layout().split(value), last, predicted);
}

Data every_kind() {
  return Dict{{"int", int32_t{-7}},
              {"long", int64_t{9'000'000'000'000'000'001}},
              {"float", 0.1f},
              {"double", -0.0},
              {"flag", true},
              {"name", "left arm"},
              {"nothing", idf::None{}},
              {"i8", NdArray::take<int8_t>({2}, {-128, 127})},
              {"i16", NdArray::take<int16_t>({2}, {-300, 300})},
              {"i32", NdArray::take<int32_t>({1, 1}, {5})},
              {"i64", NdArray::take<int64_t>({}, {INT64_MIN})},
              {"u8", NdArray::take<uint8_t>({3}, {0, 7, 255})},
              {"u16", NdArray::take<uint16_t>({1}, {65535})},
              {"u32", NdArray::take<uint32_t>({1}, {UINT32_MAX})},
              {"u64", NdArray::take<uint64_t>({1}, {UINT64_MAX})},
              {"f32", NdArray::take<float>({2}, {1.5f, -3e38f})},
              {"f64", NdArray::take<double>({2}, {1e-300, -1e300})},
              {"empty", NdArray::take<float>({0}, {})},
              {"list", idf::List{1.0, 2.0}},
              {"picture", NdArray::take<uint8_t>({8, 8, 3}, std::vector<uint8_t>(192, 9))}};
}

TEST(ValueRow, GivesTheSameBitsBackWhereNothingChanges) {
  const Data value = every_kind();
  const ValueRow rows(value);
  EXPECT_EQ(rows.elements(), 5u + 16u);
  EXPECT_EQ(rows.numbers(), rows.elements());
  EXPECT_EQ(rows.other_members().size(), 1u) << "the picture";
  EXPECT_EQ(predicted_from(rows, value, row_of(rows, value)), value);
}

TEST(ValueRow, MovesEveryKindOfNumberAndSaturates) {
  const Data value = every_kind();
  const ValueRow rows(value);
  std::vector<double> up = row_of(rows, value);
  for (double& number : up) number += 2.4;
  const Data moved = predicted_from(rows, value, up);
  EXPECT_EQ(*moved.at("int"), Data(int32_t{-5}));
  EXPECT_NEAR(*moved.at("float")->as_number(), 2.5, 1e-6);
  EXPECT_EQ(*moved.at("double"), Data(2.4));
  EXPECT_EQ(*moved.at("flag"), Data(true)) << "copied";
  EXPECT_EQ(*moved.at("name"), Data("left arm"));
  EXPECT_EQ(*moved.at("list"), *value.at("list"));
  EXPECT_EQ(*moved.at("picture"), *value.at("picture"));
  EXPECT_EQ(*moved.at("i8"), Data(NdArray::take<int8_t>({2}, {-126, 127})));
  EXPECT_EQ(*moved.at("u8"), Data(NdArray::take<uint8_t>({3}, {2, 9, 255})));
  EXPECT_EQ(*moved.at("u64"), Data(NdArray::take<uint64_t>({1}, {UINT64_MAX})));
  for (const double huge : {1e308, -1e308, kInfinity, -kInfinity, kNaN}) {
    const Data far = predicted_from(rows, value, std::vector<double>(rows.numbers(), huge));
    EXPECT_TRUE(rows.layout().split(far).ok()) << huge;
    for (const double number : row_of(rows, far)) EXPECT_TRUE(std::isfinite(number)) << huge;
  }
  EXPECT_EQ(*predicted_from(rows, value, std::vector<double>(rows.numbers(), 1e308)).at("int"),
            Data(INT32_MAX));
}

TEST(ValueRow, KeepsTheDigitsOfLargeIntegers) {
  const Data value = int64_t{9'000'000'000'000'000'001};
  const ValueRow rows(value);
  std::vector<double> row = row_of(rows, value);
  EXPECT_EQ(predicted_from(rows, value, row), value);
  row[0] += 4096;
  EXPECT_EQ(predicted_from(rows, value, row), Data(int64_t{9'000'000'000'000'004'097}));
}

TEST(ValueRow, StaysWithinTheBoundsOfTheType) {
  const Type type = Type::object(
      "Gripper", {{"width", Type::float32({"m", 0.0, 0.1})},
                  {"count", Type::int32({"", 0.5, 3.5})},
                  {"forces", Type::ndarray(ElementType::kFloat64, {2}, {"N", -1.0, std::nullopt})},
                  {"pair", Type::pair(Type::float64({"", std::nullopt, 5.0}), Type::string())},
                  {"mode", Type::int_enum("Mode", {{"open", 1}, {"closed", 7}})},
                  {"stamp", Type::time()}});
  const Data value = Dict{{"width", 0.05f},
                          {"count", int32_t{2}},
                          {"forces", NdArray::take<double>({2}, {0, 0})},
                          {"pair", idf::List{1.0, "m"}},
                          {"mode", int32_t{7}},
                          {"stamp", int64_t{1'600'000'000'000'000'000}}};
  const ValueRow rows(value, &type);
  ASSERT_EQ(rows.elements(), 7u);
  EXPECT_EQ(rows.uncounted_paths(), (std::vector<std::string>{"mode", "stamp"}));
  const Data high = predicted_from(rows, value, std::vector<double>(7, 9.0));
  EXPECT_LE(*high.at("width")->as_number(), 0.1) << "0.1 rounded to 32 bits is larger";
  EXPECT_GT(*high.at("width")->as_number(), 0.0999999);
  EXPECT_EQ(*high.at("count"), Data(int32_t{3}));
  EXPECT_EQ(*high.at("forces"), Data(NdArray::take<double>({2}, {9, 9})));
  EXPECT_EQ(*high.at("pair"), Data(idf::List{5.0, "m"}));
  EXPECT_EQ(*high.at("mode"), Data(int32_t{7})) << "between two names there is nothing";
  EXPECT_EQ(*high.at("stamp"), *value.at("stamp"));
  const Data low = predicted_from(rows, value, std::vector<double>(7, -9.0));
  EXPECT_EQ(*low.at("width"), Data(0.0f));
  EXPECT_EQ(*low.at("count"), Data(int32_t{1}));
  EXPECT_EQ(*low.at("forces"), Data(NdArray::take<double>({2}, {-1, -1})));
  EXPECT_EQ(*low.at("pair"), Data(idf::List{-9.0, "m"}));
}

TEST(ValueRow, HoldsWhatWasFiniteWhereANumberIsNone) {
  const auto value_of = [](double a, double b) { return Data(Dict{{"a", a}, {"b", b}}); };
  const ValueRow rows(value_of(1, kNaN));
  const std::vector<double> first = row_of(rows, value_of(1, kNaN));
  EXPECT_EQ(first, (std::vector<double>{1, 0}));
  const Data last = value_of(kInfinity, kNaN);
  const std::vector<double> second = row_of(rows, last, first);
  EXPECT_EQ(second, (std::vector<double>{1, 0}));
  std::vector<double> predicted{1.5, 3};
  rows.finish(second, predicted);
  Data value = rows.value(*rows.layout().split(last), second, predicted);
  EXPECT_EQ(*value.at("a"), Data(1.5));
  EXPECT_TRUE(std::isnan(value.at("b")->get<double>())) << "nobody ever knew it";
  // Also where nothing is predicted to change.
  predicted = second;
  rows.finish(second, predicted);
  value = rows.value(*rows.layout().split(last), second, predicted);
  EXPECT_EQ(*value.at("a"), Data(1.0));
  const ValueRow zero(Data(0.0));
  const std::vector<double> at_rest = row_of(zero, Data(0.0));
  EXPECT_EQ(
      zero.value(*zero.layout().split(Data(kNaN)), row_of(zero, Data(kNaN), at_rest), at_rest),
      Data(0.0));
}

TEST(ValueRow, LeavesLargeAndManyNumbersOut) {
  const Data large =
      Dict{{"scan", NdArray::take<float>({257}, std::vector<float>(257, 1.f))}, {"x", 1.0}};
  EXPECT_EQ(ValueRow(large).elements(), 1u);
  Dict many;
  for (int i = 0; i < 2000; ++i) many.set("n" + std::to_string(i), 1.0);
  EXPECT_EQ(ValueRow(Data(many)).elements(), ValueRow::kMaxNumbers);
  for (const Data& none : {Data(), Data("text"), Data(Dict{}), Data(idf::List{1.0})}) {
    EXPECT_EQ(ValueRow(none).numbers(), 0u);
    EXPECT_FALSE(ValueRow(none).has_continued());
    EXPECT_EQ(predicted_from(ValueRow(none), none, {}), none);
  }
  EXPECT_FALSE(ValueRow(Data(true)).has_continued());
}

// w, x, y, z of a turn about an axis.
std::vector<double> turn(double angle_rad, double x, double y, double z) {
  const double sine = std::sin(angle_rad / 2);
  return {std::cos(angle_rad / 2), sine * x, sine * y, sine * z};
}

TEST(ValueRow, SeesRotationsWhereTheyAre) {
  const auto numbers = [](idf::Shape shape, std::vector<double> values) {
    const ValueRow rows(Data(NdArray::take<double>(std::move(shape), std::move(values))));
    return rows.numbers() - rows.elements();
  };
  EXPECT_EQ(numbers({4}, turn(1, 0, 0, 1)), 3u);
  EXPECT_EQ(numbers({4}, {0, 0, 0, 0}), 0u);
  EXPECT_EQ(numbers({4}, {kNaN, 0, 0, 0}), 0u);
  EXPECT_EQ(numbers({4}, {1, 1, 0, 0}), 0u);
  EXPECT_EQ(numbers({3, 3}, {0, -1, 0, 1, 0, 0, 0, 0, 1}), 3u);
  EXPECT_EQ(numbers({3, 3}, {0, 1, 0, 1, 0, 0, 0, 0, 1}), 0u) << "a mirror";
  EXPECT_EQ(numbers({4, 4}, {1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1}), 3u);
  EXPECT_EQ(numbers({4, 4}, {1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7, 0, 0, 1, 1}), 0u);
  const ValueRow integers(Data(NdArray::take<int32_t>({4}, {1, 0, 0, 0})));
  EXPECT_EQ(integers.numbers(), 4u);
}

TEST(ValueRow, TurnsOnEvenlyPastHalfATurnAndEitherSign) {
  const ValueRow rows(Data(NdArray::take<double>({4}, turn(0, 0, 0, 1))));
  std::vector<double> row, before;
  for (int i = 0; i < 40; ++i) {
    std::vector<double> q = turn(0.3 * i, 0, 0, 1);
    if (q[0] < 0 || i % 5 == 0)
      for (double& part : q) part = -part;  // As canonical or careless producers do.
    row = row_of(rows, Data(NdArray::take<double>({4}, q)), before);
    EXPECT_NEAR(row[6], 0.3 * i, 1e-9);
    EXPECT_NEAR(row[4], 0, 1e-9);
    double product = 0;
    for (size_t k = 0; k < before.size() && k < 4; ++k) product += row[k] * before[k];
    EXPECT_TRUE(before.empty() || product > 0.9) << product;
    before = row;
  }
  // Whatever the sign of a quaternion, its error is that of the rotation.
  std::vector<double> negative = row;
  for (size_t i = 0; i < 4; ++i) negative[i] = -negative[i];
  EXPECT_NEAR(rows.mean_square(row, negative), 0, 1e-12);
}

TEST(ValueRow, PredictsPosesThatArePoses) {
  const double c = std::cos(0.5), s = std::sin(0.5);
  const Data value = NdArray::take<float>(
      {4, 4}, {float(c), float(-s), 0, 1, float(s), float(c), 0, 2, 0, 0, 1, 3, 0, 0, 0, 1});
  const ValueRow rows(value);
  std::vector<double> row = row_of(rows, value);
  for (double& number : row) number += 100;
  row[16] = row[17] = 0;
  row[18] = std::numbers::pi / 2;
  row[3] = 1.5;
  const Data turned = predicted_from(rows, value, row);
  const auto elements = turned.get<NdArray>().values<float>();
  EXPECT_NEAR(elements[0], std::cos(0.5 + std::numbers::pi / 2), 1e-6);
  EXPECT_NEAR(elements[4], std::sin(0.5 + std::numbers::pi / 2), 1e-6);
  EXPECT_EQ(elements[3], 1.5f);
  EXPECT_EQ(elements[7], 102.f);
  for (size_t i = 12; i < 16; ++i) EXPECT_EQ(elements[i], i == 15 ? 1.f : 0.f);
  EXPECT_EQ(ValueRow(turned).numbers(), rows.numbers()) << "it still is one";
}

TEST(ValueRow, TellsWhereARotationIsNoneAnyMore) {
  const ValueRow rows(Data(NdArray::take<double>({4}, turn(1, 0, 0, 1))));
  const Data none = NdArray::take<double>({4}, {0, 0, 0, 0});
  std::vector<double> row(rows.numbers());
  EXPECT_FALSE(rows.read(*rows.layout().split(none), {}, row));
  const std::vector<double> before =
      row_of(rows, Data(NdArray::take<double>({4}, turn(1, 0, 0, 1))));
  EXPECT_FALSE(rows.read(*rows.layout().split(none), before, row));
  const Data unknown = NdArray::take<double>({4}, {kNaN, 0, 0, 0});
  EXPECT_TRUE(rows.read(*rows.layout().split(unknown), before, row)) << "as it was before";
  EXPECT_EQ(row, before);
  EXPECT_EQ(ValueRow(none, nullptr, false).numbers(), 4u);
}

}  // namespace
}  // namespace engram::ltm
