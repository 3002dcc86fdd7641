// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/memory_id.h"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_set>
#include <utility>

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

TEST(MemoryId, IsPrefixOfWhatLiesBelowIt) {
  const MemoryId entity = *MemoryId::parse("a/b/c/d");
  const MemoryId snapshot = entity.at(kTime);
  EXPECT_TRUE(MemoryId().is_prefix_of(entity));
  EXPECT_TRUE(MemoryId::parse("a/b")->is_prefix_of(snapshot));
  EXPECT_TRUE(entity.is_prefix_of(entity));
  EXPECT_TRUE(entity.is_prefix_of(snapshot.instance(2)));
  EXPECT_TRUE(snapshot.is_prefix_of(snapshot.instance(2)));
  EXPECT_FALSE(snapshot.instance(1).is_prefix_of(snapshot.instance(2)));
  EXPECT_FALSE(snapshot.is_prefix_of(entity));
  EXPECT_FALSE(snapshot.is_prefix_of(entity.at(kTime + Duration(1))));
  EXPECT_FALSE(MemoryId::parse("a/x")->is_prefix_of(entity));
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

MemoryId random_id(RandomValues& random) {
  static const char* const kNames[] = {"a", "b", "a/", "\\", "é", "a\n", "2022-02-18"};
  std::vector<std::string> names;
  for (size_t count = random.below(6); count > 0 && names.size() < 4; --count)
    names.push_back(kNames[random.below(7)]);
  MemoryId id = *MemoryId::from_names(names);
  if (!id.has_entity() || random.below(3) == 0) return id;
  id = id.at(time_from_ns(static_cast<int64_t>(random.below(3)) - 1));
  return random.below(2) == 0 ? id : id.instance(static_cast<int32_t>(random.below(3)));
}

TEST(MemoryId, ParentsChildrenAndPrefixesAgree) {
  RandomValues random(31);
  for (int i = 0; i < 5000; ++i) {
    const MemoryId id = random_id(random), other = random_id(random);
    size_t depth = id.depth();
    for (MemoryId above = id; depth > 0; --depth) {
      const MemoryId parent = above.parent();
      EXPECT_EQ(parent.depth() + 1, above.depth());
      EXPECT_TRUE(parent.is_prefix_of(id));
      EXPECT_FALSE(above.is_prefix_of(parent));
      EXPECT_LT(parent, above);
      if (above.names().size() > parent.names().size()) {
        EXPECT_EQ(*parent.child(above.names().back()), above);
      }
      above = parent;
    }
    EXPECT_EQ(id.is_prefix_of(other) && other.is_prefix_of(id), id == other);
    EXPECT_EQ(MemoryId::parse(id.to_string()).value(), id);
    EXPECT_EQ(MemoryId::from_data(id.to_data()).value(), id);
  }
}

TEST(MemoryId, OrderKeepsWhatLiesBelowTogether) {
  RandomValues random(32);
  std::vector<MemoryId> ids;
  for (int i = 0; i < 400; ++i) ids.push_back(random_id(random));
  std::ranges::sort(ids);
  for (const MemoryId& prefix : ids) {
    int changes = 0;
    bool is_below = false;
    for (const MemoryId& id : ids)
      if (std::exchange(is_below, prefix.is_prefix_of(id)) != is_below) ++changes;
    EXPECT_LE(changes, 2) << prefix.to_string();
  }
}

TEST(MemoryId, HashesEqualIdsAlikeAndOthersApart) {
  RandomValues random(33);
  std::map<MemoryId, size_t> hashes;
  for (int i = 0; i < 5000; ++i) {
    const MemoryId id = random_id(random);
    EXPECT_EQ(hashes.emplace(id, id.hash()).first->second, id.hash());
  }
  std::set<size_t> distinct;
  for (const auto& [id, hash] : hashes) distinct.insert(hash);
  EXPECT_EQ(distinct.size(), hashes.size());
  // The same letters in other names, the same numbers on other levels.
  EXPECT_NE(MemoryId::parse("ab/c")->hash(), MemoryId::parse("a/bc")->hash());
  EXPECT_NE(MemoryId::parse("a/b")->hash(), MemoryId::parse("b/a")->hash());
}

TEST(MemoryId, RefusesChildrenThatAreNoNames) {
  const MemoryId memory = *MemoryId::parse("a");
  EXPECT_FAILS(memory.child(""), StatusCode::kInvalidArgument, "name 2 of 2 is empty");
  EXPECT_FAILS(memory.child("\xff"), StatusCode::kInvalidArgument, "no UTF-8");
  EXPECT_EQ(memory.child("b/c")->to_string(), "a/b\\/c");
  EXPECT_DEATH((void)MemoryId().parent(), "no parent");
  EXPECT_DEATH((void)MemoryId::parse("a/b/c/d")->child("e"), "has snapshots below it");
  EXPECT_DEATH((void)MemoryId::parse("a/b/c/d/0")->instance(-1), "no instance index");
  EXPECT_FAILS(MemoryId::from_data(7), StatusCode::kInvalidArgument, "found int32");
  EXPECT_FAILS(MemoryId::from_data("a//b"), StatusCode::kInvalidArgument, "empty");
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
