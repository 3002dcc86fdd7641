// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/written_value.h"

#include "tests/ltm/expect_status.h"

namespace engram::memory {
namespace {

using idf::Data;
using idf::Dict;
using idf::List;

Result<WrittenValue> json(const std::string& text) {
  return WrittenValue::parse_json(text, "a.json");
}
Result<WrittenValue> yaml(const std::string& text) {
  return WrittenValue::parse_yaml(text, "a.yaml");
}

TEST(WrittenValue, IsTheSameInJsonAndYaml) {
  const Data value = Dict{{"name", "cup"},
                          {"height", 0.25},
                          {"count", int64_t{3}},
                          {"clean", true},
                          {"owner", idf::None{}},
                          {"text", "5"},
                          {"list", List{int64_t{1}, "two", List{}}}};
  const auto from_json = json(
      R"({"name": "cup", "height": 0.25, "count": 3, "clean": true, "owner": null, "text": "5",
          "list": [1, "two", []]})");
  ASSERT_OK(from_json);
  EXPECT_EQ(from_json->data(), value);
  const auto from_yaml = yaml(
      "name: cup\nheight: 0.25\ncount: 3\nclean: true\nowner:\ntext: '5'\nlist: [1, two, []]\n");
  ASSERT_OK(from_yaml);
  EXPECT_EQ(from_yaml->data(), value);
}

TEST(WrittenValue, KnowsTheTypesOfTheJsonForm) {
  const auto array = idf::NdArray::take<float>({2}, {1, 0.5});
  EXPECT_EQ(json(R"({"a": {"$int32": 5}})")->data(), Data(Dict{{"a", int32_t{5}}}));
  EXPECT_EQ(yaml("a: {$ndarray: {type: float32, shape: [2], data: [1, 0.5]}}")->data(),
            Data(Dict{{"a", array}}));
  EXPECT_EQ(json(R"({"$$a": 1})")->data(), Data(Dict{{"$a", int64_t{1}}}));
}

TEST(WrittenValue, TellsTheLineOfWhatIsWrong) {
  const auto refuses = [](const Result<WrittenValue>& value, const std::string& start) {
    EXPECT_EQ(value.status().code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(value.status().message(), ::testing::StartsWith(start));
  };
  refuses(json("{\n\"a\": 1,\n\"b\" 2}"), "a.json:3: is no JSON: parse error");
  refuses(json("{\"a\": 1}\n\n{}"), "a.json:3: is no JSON");
  refuses(json(""), "a.json:1: is no JSON");
  refuses(json("{\"a\":\n 1,\n\"a\": 2}"), "a.json:3: found the key 'a' again");
  refuses(json("{\n\"a\": [\n1,\n{\"$int32\": 1.5}]}"), "a.json:4: JSON at '/a/1'");
  refuses(json("{\n\"a\": {\n\"$x\": 1, \"b\": 2}}"), "a.json:2: JSON at '/a'");
  refuses(json("{\n\"a\": 18446744073709551615}"), "a.json:2: JSON at '/a'");
  refuses(json("{\n\"a\": \"\xff\"}"), "a.json:2: is no JSON");
  refuses(yaml("a: 1\nb: {$int32: 1.5}"), "a.yaml:2: 'b'");
  refuses(yaml("a: 1\na: 2"), "a.yaml:2: ");
  refuses(yaml("a: [1"), "a.yaml:");
  refuses(yaml("a: \xff"), "a.yaml: is no UTF-8");
}

TEST(WrittenValue, TellsTheLineOfAnyPart) {
  const std::string text = "{\n\"a\": {\n\"b\": [\n1,\n{\"c/d\":\n\"x\"},\n5\n],\n\"$$e\": 1}}";
  const auto value = json(text);
  ASSERT_OK(value);
  const auto line = [&](std::string_view path) { return value->problem_at(path, "no"); };
  EXPECT_EQ(line(""), "a.json:1: no");
  EXPECT_EQ(line("a"), "a.json:2: no");
  EXPECT_EQ(line("a/b"), "a.json:3: no");
  EXPECT_EQ(line("a/b/0"), "a.json:4: no");
  EXPECT_EQ(line("a/b/1"), "a.json:5: no");
  EXPECT_EQ(line("a/b/1/c\\/d"), "a.json:6: no");
  EXPECT_EQ(line("a/b/2"), "a.json:7: no");
  EXPECT_EQ(line("a/$e"), "a.json:9: no");
  EXPECT_EQ(line("a/b/7"), "a.json:3: no") << "around what is missing";
  EXPECT_EQ(line("a/nothing/there"), "a.json:2: no");
  const auto other = yaml("a:\n  b:\n    - 1\n    - c: x\n");
  EXPECT_EQ(other->problem_at("a/b/1/c", "no"), "a.yaml:4: 'a.b[1].c': no");
  EXPECT_EQ(other->problem_at("a/b/7/c", "no").substr(0, 9), "a.yaml:3:");
}

TEST(WrittenValue, ReadsNoBottomlessText) {
  for (const char* piece : {"[", "{\"a\":"}) {
    std::string text;
    for (int i = 0; i < 1'000'000; ++i) text += piece;
    EXPECT_FAILS(json(text), StatusCode::kInvalidArgument, "nests deeper");
  }
  EXPECT_FALSE(json(std::string(100, '[') + std::string(100, ']')).ok());
  EXPECT_OK(json(std::string(60, '[') + std::string(60, ']')));
}

}  // namespace
}  // namespace engram::memory
