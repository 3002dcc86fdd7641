// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/data.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/ltm/random_values.h"

namespace engram::idf {
namespace {

using Names = std::vector<std::string>;

TEST(Data, FindsValuesByPath) {
  Data value = Dict{{"pose", Dict{{"position", List{1.0, 2.0, 3.0}}}}, {"a/b", 5}, {"", 6}};
  EXPECT_EQ(*value.at("pose/position/2"), Data(3.0));
  EXPECT_EQ(*value.at("a\\/b"), Data(5));
  EXPECT_EQ(*value.at("\\e"), Data(6));
  EXPECT_EQ(value.at(""), &value);
  for (const char* path : {"pose/position/3", "pose/position/-1", "pose/position/x", "a/b",
                           "pose/x", "a\\/b/c", "pose/position/"})
    EXPECT_EQ(value.at(path), nullptr) << path;
  *value.at("pose/position/0") = "changed";
  EXPECT_EQ(*value.at("pose/position/0"), Data("changed"));
}

TEST(Data, SplitsAndJoinsPaths) {
  EXPECT_EQ(split_path("a/b"), (Names{"a", "b"}));
  EXPECT_EQ(split_path("a\\/b/c"), (Names{"a/b", "c"}));
  EXPECT_EQ(split_path("a\\\\/b"), (Names{"a\\", "b"}));
  EXPECT_EQ(split_path("\\e/a"), (Names{"", "a"}));
  EXPECT_EQ(join_path("", "a/b"), "a\\/b");
  EXPECT_EQ(join_path("x", ""), "x/\\e");
}

TEST(Data, GivesBackEveryNameOfAPath) {
  RandomValues random(2);
  for (int i = 0; i < 2000; ++i) {
    Names names;
    std::string path;
    for (size_t count = 1 + random.below(4); count > 0; --count) {
      names.push_back(random.key());
      path = join_path(path, names.back());
    }
    EXPECT_EQ(split_path(path), names) << path;
  }
}

TEST(Data, ComparesNumbersBitByBit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Data(nan), Data(nan));
  EXPECT_NE(Data(nan), Data(-nan));
  EXPECT_NE(Data(0.0), Data(-0.0));
  EXPECT_NE(Data(1), Data(int64_t{1}));
  EXPECT_NE(Data(1.0f), Data(1.0));
  EXPECT_NE(Data(), Data(false));
}

TEST(Data, NamesItsKind) {
  EXPECT_EQ(Data().kind_name(), "none");
  EXPECT_EQ(Data(1.0f).kind_name(), "float32");
  EXPECT_EQ(Data(NdArray()).kind_name(), "ndarray");
  EXPECT_EQ(Data(Dict()).kind_name(), "dict");
}

TEST(Data, GivesScalarsAsNumbers) {
  EXPECT_EQ(Data(true).as_number(), 1.0);
  EXPECT_EQ(Data(int64_t{-3}).as_number(), -3.0);
  EXPECT_EQ(Data("3").as_number(), std::nullopt);
}

TEST(Dict, KeepsTheOrderAndUniquenessOfKeys) {
  Dict dict{{"b", 1}, {"a", 2}, {"b", 3}};
  ASSERT_EQ(dict.size(), 2u);
  EXPECT_EQ(dict.begin()->key, "b");
  EXPECT_EQ(*dict.find("b"), Data(3));
  EXPECT_EQ(dict.find("c"), nullptr);
  EXPECT_NE(dict, (Dict{{"a", 2}, {"b", 3}}));
}

}  // namespace
}  // namespace engram::idf
