// SPDX-License-Identifier: Apache-2.0
#include "ltm/typed/convert.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ltm/typed/convert_eigen.h"
#include "ltm/typed/defaults.h"

namespace engram::typed {
namespace {

using idf::Type;

TEST(Convert, NumbersAreEqualByTheirBits) {
  EXPECT_TRUE(equal(std::nanf(""), std::nanf("")));
  EXPECT_FALSE(equal(0.0, -0.0));
  EXPECT_TRUE(equal(int64_t{5}, int64_t{5}));
}

TEST(Convert, MatricesAreRowMajorInValues) {
  Eigen::Matrix<int32_t, 2, 3> matrix;
  matrix << 1, 2, 3, 4, 5, 6;
  const Type type = Type::matrix(2, 3, idf::ElementType::kInt32);
  const idf::Data data = write(matrix, type);
  const auto values = data.get<idf::NdArray>().values<int32_t>();
  EXPECT_EQ(std::vector<int32_t>(values.begin(), values.end()),
            (std::vector<int32_t>{1, 2, 3, 4, 5, 6}));
  Eigen::Matrix<int32_t, 2, 3> read_back;
  ASSERT_TRUE(read(data, type, read_back));
  EXPECT_TRUE(equal(matrix, read_back));
}

TEST(Convert, MapsKeepKeysInOrder) {
  using Map = std::map<std::string, int32_t, std::less<>>;
  const Type type = Type::dict(Type::int32());
  Map map;
  ASSERT_TRUE(read(idf::Dict{{"b", 1}, {"a", 2}}, type, map));
  EXPECT_EQ(map, (Map{{"a", 2}, {"b", 1}}));
  EXPECT_TRUE(write(map, type) == (idf::Dict{{"a", 2}, {"b", 1}}));
}

TEST(Convert, OptionalIsNoneWhereAbsent) {
  const Type type = Type::int32().optional();
  EXPECT_TRUE(write(std::optional<int32_t>(), type).is<idf::None>());
  std::optional<int32_t> value = 5;
  ASSERT_TRUE(read(idf::None{}, type, value));
  EXPECT_FALSE(value.has_value());
}

TEST(Convert, FilledArraysHoldTheirValue) {
  const idf::NdArray array = filled<int16_t>({2, 2}, int16_t{7});
  EXPECT_EQ(array.values<int16_t>()[3], 7);
  EXPECT_EQ((repeated<3, int32_t>(4)), (std::array<int32_t, 3>{4, 4, 4}));
}

}  // namespace
}  // namespace engram::typed
