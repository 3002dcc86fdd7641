// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/json.h"

#include <limits>
#include <nlohmann/json.hpp>

#include "ltm/idf/binary.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram::idf {
namespace {

void expect_round_trip(const Data& value) {
  const auto text = to_json_text(value);
  ASSERT_OK(text);
  const auto read = from_json_text(*text);
  ASSERT_OK(read);
  EXPECT_EQ(*read, value) << *text;
}

TEST(Json, GivesBackRandomValues) {
  RandomValues random(6);
  for (int i = 0; i < 3000; ++i) expect_round_trip(random.value(5));
}

TEST(Json, LooksPlainWhereJsonLosesNothing) {
  EXPECT_EQ(*to_json_text(Dict{{"b", List{true, Data(), 1.5, "x"}}, {"a", int64_t{5}}}),
            R"({"b":[true,null,1.5,"x"],"a":5})");
  EXPECT_EQ(*to_json_text(Data(5)), R"({"$int32":5})");
  EXPECT_EQ(*to_json_text(Data(1.5f)), R"({"$float32":1.5})");
  EXPECT_EQ(*to_json_text(NdArray::take<float>({3}, {1, 2, 3})),
            R"({"$ndarray":{"type":"float32","shape":[3],"data":[1.0,2.0,3.0]}})");
}

TEST(Json, KeepsIntegersBeyondTheReachOfDoubles) {
  constexpr int64_t kExact = int64_t{1} << 53;
  for (const int64_t value :
       {kExact - 1, kExact, kExact + 1, -kExact, -kExact - 1, INT64_MAX, INT64_MIN, int64_t{0}})
    expect_round_trip(value);
  EXPECT_EQ(*to_json_text(kExact - 1), "9007199254740991");
  EXPECT_EQ(*to_json_text(kExact + 1), R"({"$int64":"9007199254740993"})");
  EXPECT_FAILS(from_json_text("18446744073709551615"), StatusCode::kInvalidArgument,
               "beyond int64");
}

TEST(Json, KeepsNumbersThatJsonDoesNotKnow) {
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::quiet_NaN(),
        std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), -0.0,
        5e-324, std::numeric_limits<double>::max(), std::bit_cast<double>(~uint64_t{0})}) {
    expect_round_trip(value);
    expect_round_trip(static_cast<float>(value));
    expect_round_trip(NdArray::take<double>({1}, {value}));
  }
  EXPECT_EQ(*to_json_text(std::numeric_limits<double>::quiet_NaN()), R"({"$float64":"nan"})");
  EXPECT_EQ(*to_json_text(std::numeric_limits<float>::infinity()), R"({"$float32":"inf"})");
}

TEST(Json, KeepsKeysThatLookLikeTypes) {
  for (const char* key : {"$int32", "$", "$$", "$$int32", "$ndarray"}) {
    expect_round_trip(Dict{{key, int64_t{5}}});
    expect_round_trip(Dict{{key, int64_t{5}}, {"other", 1}});
  }
}

TEST(Json, WritesLargeArraysAsBase64) {
  const NdArray array = NdArray::take<uint8_t>({64}, std::vector<uint8_t>(64, 3));
  EXPECT_THAT(*to_json_text(array), ::testing::HasSubstr("\"base64\""));
  expect_round_trip(array);
}

TEST(Json, RefusesBrokenValuesAndNamesTheirPlace) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"a": {"$int32": 2147483648}})", "'/a'"},
      {R"([{"$int64": "5x"}])", "'/0'"},
      {R"({"$float32": 1e300})", "$float32"},
      {R"({"$float64": "nan:0"})", "$float64"},
      {R"({"$unknown": 1})", "$unknown"},
      {R"({"$int32": 1, "b": 2})", "beside other keys"},
      {R"({"$ndarray": {"type": "float16", "shape": [1], "data": [1]}})", "unknown element type"},
      {R"({"$ndarray": {"type": "uint8", "shape": [2], "data": [1]}})", "found 1 bytes, needs 2"},
      {R"({"$ndarray": {"type": "uint8", "shape": [-1], "data": []}})", "[-1]"},
      {R"({"$ndarray": {"type": "uint8", "shape": [1], "data": [256]}})", "does not fit"},
      {R"({"$ndarray": {"type": "uint8", "shape": [1], "base64": "!!"}})", "broken base64"},
      {R"({"$ndarray": {"type": "uint8", "shape": [1]}})", "without data"},
      {R"({"$ndarray": {"shape": [1]}})", "without type"},
      {R"({"$ndarray": {"type": "uint8", "shape": [1.5], "data": [1]}})", "not of integers"},
      {"", "no JSON"},
      {"{", "no JSON"},
      {"1e999", "no JSON"},
      {"nan", "no JSON"}};
  for (const auto& [text, part] : cases)
    EXPECT_FAILS(from_json_text(text), StatusCode::kInvalidArgument, part);
}

TEST(Json, NestsSixtyFourLevelsDeep) {
  expect_round_trip(nested_lists(64));
  expect_round_trip(nested_dicts(64));
  EXPECT_FAILS(to_json(nested_lists(65)), StatusCode::kInvalidArgument, "64 levels");
  EXPECT_FAILS(from_json_text(std::string(65, '[') + std::string(65, ']')),
               StatusCode::kInvalidArgument, "64 levels");
  for (const size_t depth : {1000, 1'000'000}) {
    EXPECT_FAILS(from_json_text(std::string(depth, '[')), StatusCode::kInvalidArgument, "");
    EXPECT_FAILS(from_json_text(std::string(depth, '[') + std::string(depth, ']')),
                 StatusCode::kInvalidArgument, "levels");
  }
}

TEST(Json, RefusesWhatWouldBeGuessed) {
  EXPECT_FAILS(from_json_text(R"({"a": 1, "b": {"c": 2, "c": 3}})"), StatusCode::kInvalidArgument,
               "the key 'c' twice");
  EXPECT_OK(from_json_text(R"([{"a": 1}, {"a": {"a": 2}}])"));
  for (const char* text : {"18446744073709551616", "-9223372036854775809",
                           "[1, 1"
                           "00000000000000000000000]"})
    EXPECT_FAILS(from_json_text(text), StatusCode::kInvalidArgument, "needs one of 64 bits");
  EXPECT_FAILS(from_json_text("18446744073709551615"), StatusCode::kInvalidArgument, "int64");
  EXPECT_OK(from_json_text("-9223372036854775808"));
  EXPECT_OK(from_json_text("1e300"));
  for (const char* text : {R"({"$int32": 2147483648})", R"({"$int64": "9223372036854775808"})"})
    EXPECT_FAILS(from_json_text(text), StatusCode::kInvalidArgument, "unfitting value");
}

TEST(Json, RefusesStringsThatAreNoUtf8) {
  EXPECT_FAILS(to_json_text(Data("\xff")), StatusCode::kInvalidArgument, "UTF-8");
}

TEST(Json, SurvivesRandomDamage) {
  RandomValues random(7);
  for (int i = 0; i < 100; ++i) {
    const std::string text = *to_json_text(random.value(4));
    for (int k = 0; k < 100; ++k) {
      std::string damaged = text;
      damaged[random.below(damaged.size())] = static_cast<char>(random.bits());
      const auto read = from_json_text(damaged);
      if (read.ok()) (void)encode(*read).ok();
    }
  }
}

}  // namespace
}  // namespace engram::idf
