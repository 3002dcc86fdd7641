// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/links.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/print_values.h"
#include "tests/ltm/random_types.h"

namespace engram::ltm {

void PrintTo(const Link& link, std::ostream* out) {
  *out << link.path << " -> " << link.id.to_string();
}

namespace {

using idf::Data;
using idf::Dict;
using idf::List;
using idf::Type;

constexpr const char* kImage = "Vision/RGB/head/cam/2022-02-18 13:06:56.492182/0";
constexpr const char* kGrasp = "Grasp/Plan/planner/cup/2022-02-18 13:06:57.000000";

MemoryId id(std::string_view text) {
  auto parsed = MemoryId::parse(text);
  EXPECT_OK(parsed);
  return *parsed;
}

Type result_type() {
  return Type::object("Result",
                      {{"inputs", Type::list(Type::memory_link())},
                       {"goal", Type::memory_link().optional()},
                       {"by/name", Type::dict(Type::pair(Type::string(), Type::memory_link()))},
                       {"note", Type::string()}});
}

Data result() {
  return Dict{{"inputs", List{kImage, "", "Vision"}},
              {"goal", idf::None{}},
              {"by/name", Dict{{"", List{kImage, kGrasp}}}},
              {"note", kGrasp}};
}

TEST(Links, AreFoundWhereTheTypeHasThem) {
  const std::vector<Link> expected{
      {"inputs/0", id(kImage)}, {"inputs/2", id("Vision")}, {"by\\/name/\\e/1", id(kGrasp)}};
  EXPECT_EQ(find_links(result(), result_type()), expected);
}

TEST(Links, AreGuessedWithoutAType) {
  const std::vector<Link> expected{{"inputs/0", id(kImage)},
                                   {"by\\/name/\\e/0", id(kImage)},
                                   {"by\\/name/\\e/1", id(kGrasp)},
                                   {"note", id(kGrasp)}};
  EXPECT_EQ(find_links(result()), expected);
  EXPECT_TRUE(find_links(Data("a/b/c/d/e")).empty());
  EXPECT_TRUE(find_links(Data("a/b/c/d")).empty());
  EXPECT_EQ(find_links(Data(kImage)).size(), 1u);
}

TEST(Links, StandWhereTheirPathSays) {
  RandomTypes random(17);
  size_t count = 0;
  for (int i = 0; i < 3000; ++i) {
    const Type type = random.type(4);
    const Data value = random.value_of(type);
    for (const Link& link : find_links(value, type)) {
      const Data* text = value.at(link.path);
      ASSERT_NE(text, nullptr) << link.path;
      EXPECT_EQ(id(text->get<std::string>()), link.id);
      ++count;
    }
  }
  EXPECT_GT(count, 100u);
}

TEST(Links, BrokenOnesAreReportedWithTheirPath) {
  EXPECT_TRUE(check_links(result(), result_type()).empty());
  const auto broken = check_links(List{"a/b/c/d/never"}, Type::list(Type::memory_link()));
  ASSERT_EQ(broken.size(), 1u);
  EXPECT_EQ(broken[0].path, "0");
  EXPECT_THAT(broken[0].needed, ::testing::HasSubstr("memory ID"));
}

TEST(Links, AreRewritten) {
  const auto to_grasp = [](const MemoryId& link) -> std::optional<MemoryId> {
    if (link == id(kImage)) return id(kGrasp);
    return std::nullopt;
  };
  const Data typed = rewrite_links(result(), result_type(), to_grasp);
  EXPECT_EQ(*typed.at("inputs/0"), Data(kGrasp));
  EXPECT_EQ(*typed.at("inputs/2"), Data("Vision"));
  EXPECT_EQ(*typed.at("by\\/name/\\e/0"), Data(kImage));
  const Data untyped = rewrite_links(result(), to_grasp);
  EXPECT_EQ(*untyped.at("by\\/name/\\e/0"), Data(kGrasp));
  EXPECT_EQ(rewrite_links(result(), [](const MemoryId&) { return std::nullopt; }), result());
}

TEST(Links, AreResolvedOnceForEachId) {
  int asked = 0;
  const auto lookup = [&asked](const MemoryId& link) -> Result<Data> {
    ++asked;
    if (link == id(kImage)) return Data(5);
    return not_found("no '{}'", link.to_string());
  };
  const auto resolved = resolve_links(find_links(result()), lookup);
  ASSERT_EQ(resolved.size(), 4u);
  EXPECT_EQ(asked, 2);
  ASSERT_OK(resolved[0].target);
  EXPECT_EQ(*resolved[1].target, Data(5));
  EXPECT_FAILS(resolved[3].target, StatusCode::kNotFound, "Grasp");
}

}  // namespace
}  // namespace engram::ltm
