// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/memory_id.h"

#include <unordered_set>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram::ltm {
namespace {

const Time kTime = time_from_ns(1645189616492182000);

TEST(MemoryId, PrintsAndReadsEveryLevel) {
  for (const char* text :
       {"", "Grasp", "Grasp/Affordance", "Grasp/Affordance/MyGraspPlanner",
        "Grasp/Affordance/MyGraspPlanner/blue-cup",
        "Grasp/Affordance/MyGraspPlanner/blue-cup/2022-02-18 13:06:56.492182",
        "Grasp/Affordance/MyGraspPlanner/blue-cup/2022-02-18 13:06:56.492182/1"}) {
    const auto id = MemoryId::parse(text);
    ASSERT_OK(id);
    EXPECT_EQ(id->to_string(), text);
  }
}

TEST(MemoryId, ReadsBackAnyNames) {
  RandomValues random(21);
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::string> names;
    for (size_t count = random.below(5); count > 0; --count) names.push_back("x" + random.text());
    MemoryId id = *MemoryId::from_names(names);
    if (id.has_entity() && random.below(2) == 0) {
      id = id.at(time_from_ns(static_cast<int64_t>(random.bits())));
      if (random.below(2) == 0) id = id.instance(static_cast<int32_t>(random.below(100)));
    }
    const auto read = MemoryId::parse(id.to_string());
    ASSERT_OK(read);
    EXPECT_EQ(*read, id) << id.to_string();
  }
}

TEST(MemoryId, EscapesSlashesInNames) {
  const auto id = MemoryId::parse("Vision/RGB/head\\/left/c\\\\");
  ASSERT_OK(id);
  EXPECT_EQ(id->names(), (std::vector<std::string>{"Vision", "RGB", "head/left", "c\\"}));
}

TEST(MemoryId, RefusesWhatIsNone) {
  const std::pair<const char*, const char*> cases[] = {
      {"a//b", "name 2 of 3 is empty"},
      {"/a", "name 1 of 2 is empty"},
      {"a/b/c/d/e", "'e' is no time"},
      {"a/b/c/d/0/x", "'x' is no instance index"},
      {"a/b/c/d/0/-1", "'-1' is no"},
      {"a/b/c/d/0/1/2", "has 7 parts"},
      {"a/\\e", "name 2 of 2 is empty"},
      {"a/b/c/d/0/99999999999", "no instance index"},
      {"a\xff", "no UTF-8"},
      {"a/\xc0\xaf", "no UTF-8"},
      {"\xed\xa0\x80", "no UTF-8"},
      {"\xf5\x80\x80\x80", "no UTF-8"},
      {"a\xe2\x82", "no UTF-8"}};
  for (const auto& [text, part] : cases)
    EXPECT_FAILS(MemoryId::parse(text), StatusCode::kInvalidArgument, part);
  EXPECT_FAILS(MemoryId::from_names({"a", "b", "c", "d", "e"}), StatusCode::kInvalidArgument,
               "5 names");
  EXPECT_OK(MemoryId::from_names({"ü", "机", "🤖", "\x7f"}));
}

TEST(MemoryId, ContainsWhatLiesBelowIt) {
  const MemoryId entity = *MemoryId::parse("a/b/c/d");
  const MemoryId snapshot = entity.at(kTime);
  EXPECT_TRUE(MemoryId().contains(entity));
  EXPECT_TRUE(MemoryId::parse("a/b")->contains(snapshot));
  EXPECT_TRUE(entity.contains(entity));
  EXPECT_TRUE(entity.contains(snapshot.instance(2)));
  EXPECT_TRUE(snapshot.contains(snapshot.instance(2)));
  EXPECT_FALSE(snapshot.instance(1).contains(snapshot.instance(2)));
  EXPECT_FALSE(snapshot.contains(entity));
  EXPECT_FALSE(snapshot.contains(entity.at(kTime + Duration(1))));
  EXPECT_FALSE(MemoryId::parse("a/x")->contains(entity));
}

TEST(MemoryId, OrdersByNameThenTimeThenIndex) {
  const MemoryId entity = *MemoryId::parse("a/b/c/d");
  EXPECT_LT(*MemoryId::parse("a/b"), entity);
  EXPECT_LT(entity, entity.at(kTime));
  EXPECT_LT(entity.at(kTime), entity.at(kTime + Duration(1)));
  EXPECT_LT(entity.at(kTime).instance(0), entity.at(kTime).instance(1));
  EXPECT_LT(entity.at(kTime + Duration(1)), *MemoryId::parse("a/b/c/e"));
  EXPECT_EQ(std::unordered_set<MemoryId>({entity, entity, entity.at(kTime)}).size(), 2u);
}

TEST(MemoryId, KnowsItsLevel) {
  const MemoryId entity = *MemoryId::parse("a/b/c/d");
  EXPECT_TRUE(entity.is_entity());
  EXPECT_FALSE(entity.at(kTime).is_entity());
  EXPECT_TRUE(entity.at(kTime).has_entity());
  EXPECT_EQ(entity.at(kTime).instance(3).entity(), entity);
  EXPECT_EQ(entity.at(kTime).instance(3).index(), 3);
  EXPECT_FALSE(MemoryId::parse("a/b/c")->has_entity());
  EXPECT_DEATH((void)MemoryId().at(kTime), "has no entity");
  EXPECT_DEATH((void)entity.instance(0), "is no snapshot");
}

}  // namespace
}  // namespace engram::ltm
