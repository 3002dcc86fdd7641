// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/snapshot_condition.h"

#include <random>

#include "ltm/memory/query.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram::ltm {
namespace {

using Sighting = where::InView::Sighting;

MemoryId id_of(const std::string& text) {
  return *MemoryId::parse(text);
}

/// The snapshots that a query of one branch asks for.
std::vector<SnapshotQuery> asked(const std::string& selectors) {
  const auto query = Query::parse("a/b/c/d @ " + selectors);
  EXPECT_OK(query);
  if (!query.ok()) return {};
  const auto again = Query::parse(query->to_string());
  EXPECT_OK(again);
  EXPECT_EQ(*again, *query) << query->to_string();
  return query->memories().at(0).below.at(0).below.at(0).below.at(0).below;
}

TEST(Condition, ReadsEveryKind) {
  const MemoryId cup = id_of("Objects/Instances/kitchen/cup_1");
  const std::pair<std::string, Condition> cases[] = {
      {"within Objects/Instances/kitchen/cup_1 0.3m", {where::Within{cup, 0.3}}},
      {"within Objects/Instances/kitchen/cup_1 30cm", {where::Within{cup, 0.3}}},
      {"within Objects/Instances/kitchen/cup_1 300mm", {where::Within{cup, 0.3}}},
      {"not within Objects/Instances/kitchen/cup_1 2km", {where::Within{cup, 2000}, true}},
      {"near 1,-2.5,0.9 0.5m", {where::Near{{1, -2.5, 0.9}, 0.5}}},
      {"near 1, -2.5, 0.9 0.5m", {where::Near{{1, -2.5, 0.9}, 0.5}}},
      {"near 1,2,3 0.5m in map", {where::Near{{1, 2, 3}, 0.5, "map"}}},
      {"in-view Objects/Instances/kitchen/cup_1", {where::InView{cup, Sighting::kAny}}},
      {"seen-with Objects/Instances/kitchen/cup_1", {where::InView{cup, Sighting::kSeen}}},
      {"in-vain Objects/Instances/kitchen/cup_1", {where::InView{cup, Sighting::kInVain}}},
      {"while Skill/Event/robot/pick", {where::While{id_of("Skill/Event/robot/pick")}}},
      {"linked-to a/b/c/d/2022-02-18 13:06:56.492182/1",
       {where::LinkedTo{id_of("a/b/c/d/2022-02-18 13:06:56.492182/1")}}},
      {"links-from a/b/c/d", {where::LinksFrom{id_of("a/b/c/d")}}},
      {"not while a/b/c/a\\ while\\ ago", {where::While{id_of("a/b/c/a while ago")}, true}},
      {"while a/b\\,c/x\\;y/d\\/e", {where::While{id_of("a/b,c/x;y/d\\/e")}}}};
  for (const auto& [text, expected] : cases) {
    const auto snapshots = asked("all " + text);
    ASSERT_EQ(snapshots.size(), 1) << text;
    ASSERT_EQ(snapshots[0].conditions.size(), 1) << text;
    EXPECT_EQ(snapshots[0].conditions[0], expected) << text;
  }
}

TEST(Condition, CombinesWithSelectorsInstancesAndOthers) {
  const auto snapshots =
      asked("latest:3#1 near 1,2,3 0.5m while a/b/c/e, all, -3..-1 in-view a/b/c/f");
  ASSERT_EQ(snapshots.size(), 3);
  EXPECT_EQ(snapshots[0].selector, Selector(select::Latest{3}));
  EXPECT_EQ(snapshots[0].instances, std::vector<int32_t>{1});
  EXPECT_EQ(snapshots[0].conditions.size(), 2);
  EXPECT_TRUE(snapshots[1].conditions.empty());
  EXPECT_EQ(snapshots[2].selector, Selector(select::IndexRange{-3, -1}));
  EXPECT_EQ(snapshots[2].conditions.size(), 1);
  // Equal selectors with other conditions are not one.
  EXPECT_EQ(asked("latest, latest while a/b/c/e").size(), 2);
  EXPECT_EQ(asked("latest#0 while a/b/c/e, latest#1 while a/b/c/e").size(), 1);
}

TEST(Condition, RefusesWhatIsBroken) {
  const std::pair<std::string, std::string> cases[] = {
      {"all within a/b/c/d", "needs an entity and a length"},
      {"all within a/b/c/d 3", "is no length"},
      {"all within a/b/c/d -1m", "is no distance"},
      {"all within a/b/c/d nanm", "is no distance"},
      {"all within a/b/c 1m", "is no entity"},
      {"all within a/b/c/d/2022-02-18 13:06:56 1m", "is no entity"},
      {"all near 1,2 1m", "is no point"},
      {"all near 1,2,x 1m", "is no point"},
      {"all near 1,2,inf 1m", "is no point"},
      {"all near 1,2,3", "needs a point and a length"},
      {"all in-view", "needs an entity"},
      {"all not", "is no condition"},
      {"all not not while a/b/c/d", "is no condition"},
      {"all linked-to a/b/c", "is no ID of an entity"},
      {"all links-from", "needs an ID"},
      {"while a/b/c/d", "is no selector"},
      {"+200ms while a/b/c/d", "no prediction meets"}};
  for (const auto& [selectors, message] : cases) {
    const auto query = Query::parse("a/b/c/d @ " + selectors);
    ASSERT_FALSE(query.ok()) << selectors;
    EXPECT_EQ(query.status().code(), StatusCode::kInvalidArgument) << selectors;
    EXPECT_NE(query.status().message().find(message), std::string::npos)
        << selectors << ": " << query.status().message();
  }
  std::string many = "a/b/c/d @ all";
  for (size_t i = 0; i <= Query::kMaxConditions; ++i) many += fmt::format(" near {},2,3 1m", i);
  EXPECT_EQ(Query::parse(many).status().code(), StatusCode::kInvalidArgument);
}

/// Names of anything that a query gives a meaning to.
std::string hostile_name(std::mt19937& random) {
  static const std::string kParts[] = {" ",  ",", ";", "/", "\\", "not", "while", "near",
                                       "in", "@", "#", "x", "é",  "..",  "0.3m",  "1"};
  std::string name;
  for (int i = std::uniform_int_distribution<int>(1, 6)(random); i > 0; --i)
    name += kParts[std::uniform_int_distribution<size_t>(0, std::size(kParts) - 1)(random)];
  return name;
}

TEST(Condition, ReadsBackHostileNames) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-10, 10);
  for (int round = 0; round < 2000; ++round) {
    const auto entity = MemoryId::from_names(
        {hostile_name(random), hostile_name(random), hostile_name(random), hostile_name(random)});
    ASSERT_OK(entity);
    MemoryId deeper = *entity;
    if (round % 2 == 0) deeper = deeper.at(time_from_ns(1'700'000'000'123'456'789 + round));
    if (round % 4 == 0) deeper = deeper.instance(round);
    const Condition all[] = {
        {where::Within{*entity, std::abs(any(random))}},
        {where::Near{
            {any(random), any(random), any(random)}, std::abs(any(random)), hostile_name(random)}},
        {where::InView{*entity, Sighting::kInVain}, true},
        {where::While{*entity}},
        {where::LinkedTo{deeper}},
        {where::LinksFrom{deeper}, true}};
    std::vector<Condition> some;
    for (const Condition& condition : all)
      if (random() % 2 == 0) some.push_back(condition);
    SnapshotQuery snapshots{select::Latest{2}, {}, some};
    const auto any_name = *NamePattern::parse(".*");
    const auto query =
        Query::create({{any_name, {{any_name, {{any_name, {{any_name, {snapshots}}}}}}}}});
    ASSERT_OK(query);
    const auto again = Query::parse(query->to_string());
    ASSERT_OK(again);
    EXPECT_EQ(*again, *query) << query->to_string();
  }
}

}  // namespace
}  // namespace engram::ltm
