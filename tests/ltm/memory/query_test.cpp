// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/query.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/memory/random_memory.h"
#include "tests/ltm/random_values.h"

namespace engram::ltm {
namespace {

const Time kT1 = time_from_ns(1645189616492182000);
const Time kT2 = kT1 + std::chrono::seconds(5);

/// The selectors of a query with one branch.
std::vector<SnapshotQuery> snapshots(const Query& query) {
  return query.memories().at(0).below.at(0).below.at(0).below.at(0).below;
}

Selector selector_of(const std::string& text) {
  const auto query = Query::parse("a/b/c/d @ " + text);
  EXPECT_OK(query);
  return query.ok() ? snapshots(*query).front().selector : Selector();
}

TEST(Query, ReadsEverySelector) {
  using namespace std::chrono_literals;
  const std::string t1 = to_string(kT1), t2 = to_string(kT2);
  const std::pair<std::string, Selector> cases[] = {
      {"all", select::All{}},
      {"latest", select::Latest{}},
      {"latest:3", select::Latest{3}},
      {t1, select::At{kT1}},
      {"2022-02-18T13:06:56.492182Z", select::At{kT1}},
      {"1645189616492182000", select::At{kT1}},
      {"time:5", select::At{time_from_ns(5)}},
      {"+200ms", select::Ahead{200ms}},
      {"+-1s", select::Ahead{-1s}},
      {"nearest:" + t1, select::Nearest{.time = kT1}},
      {"nearest:" + t1 + "~50ms", select::Nearest{kT1, 50ms}},
      {"before:" + t1, select::Before{kT1, false}},
      {"at-or-before:" + t1, select::Before{kT1, true}},
      {"after:" + t1, select::After{kT1}},
      {t1 + ".." + t2, select::TimeRange{kT1, kT2}},
      {t1 + " .. " + t2, select::TimeRange{kT1, kT2}},
      {"time:1..3", select::TimeRange{time_from_ns(1), time_from_ns(3)}},
      {"1000000000..2000000000",
       select::TimeRange{time_from_ns(1'000'000'000), time_from_ns(2'000'000'000)}},
      {"last:10s", select::LastDuration{10s}},
      {"-3..-1", select::IndexRange{-3, -1}},
      {"0..9", select::IndexRange{0, 9}},
      {"index:1000000000..2000000000", select::IndexRange{1'000'000'000, 2'000'000'000}}};
  for (const auto& [text, expected] : cases) {
    EXPECT_EQ(selector_of(text), expected) << text;
    const Query query = *Query::parse("a/b/c/d @ " + text);
    const auto again = Query::parse(query.to_string());
    ASSERT_OK(again);
    EXPECT_EQ(*again, query) << query.to_string();
  }
}

TEST(Query, ReadsBackRandomSelectors) {
  RandomValues random(22);
  const auto time = [&] { return time_from_ns(static_cast<int64_t>(random.bits())); };
  for (int i = 0; i < 3000; ++i) {
    const Time a = time(), b = time();
    const Duration d(static_cast<int64_t>(random.bits() >> 2));
    const auto n = static_cast<int64_t>(random.bits() >> 3) + 1;
    const Selector selectors[] = {
        select::Latest{n},       select::At{a},
        select::Ahead{d},        select::Ahead{-d},
        select::Nearest{a, d},   select::Before{a, i % 2 == 0},
        select::After{a},        select::TimeRange{std::min(a, b), std::max(a, b)},
        select::LastDuration{d}, select::IndexRange{-n, n}};
    for (const Selector& selector : selectors) {
      const Query query({}, selector);
      const auto read = Query::parse(query.to_string());
      ASSERT_OK(read);
      EXPECT_EQ(*read, query) << query.to_string();
    }
  }
}

TEST(Query, WithoutSelectorMeansTheLatest) {
  EXPECT_EQ(selector_of("latest"), Selector(select::Latest{}));
  EXPECT_EQ(snapshots(*Query::parse("a/b/c/d")), std::vector<SnapshotQuery>{SnapshotQuery{}});
  EXPECT_EQ(*Query::parse(""), Query());
  EXPECT_EQ(*Query::parse(" @ all"), Query({}, select::All{}));
  EXPECT_EQ(*Query::parse("@ all"), Query({}, select::All{}));
  EXPECT_EQ(snapshots(*Query::parse("a @all"))[0].selector, Selector(select::All{}));
}

TEST(Query, RefusesWhatIsBroken) {
  const std::pair<const char*, const char*> cases[] = {
      {"a/b/c/d/e", "has 5 name levels"},
      {"a//c", "empty"},
      {"a/(", "no regular expression"},
      {"a @ latest:0", "above zero"},
      {"a @ latest:x", "above zero"},
      {"a @ last:-1s", "positive duration"},
      {"a @ last:x", "'x' is no duration"},
      {"a @ +x", "is no duration"},
      {"a @ nearest:x", "'x' is no time"},
      {"a @ nearest:5~-1s", "negative"},
      {"a @ index:3", "no index range"},
      {"a @ before:", "is no time"},
      {"a @ 2022-01-02..2022-01-01", "ends before it starts"},
      {"a @ time:5..1", "ends before it starts"},
      {"a @ 1..x", "'x' is no time"},
      {"a @ sometimes", "'sometimes' is no time"},
      {"a @ ", "is no selector"},
      {"a @ all,", "is no selector"},
      {"a @ all#", "'' is no instance index"},
      {"a @ all#-1", "'-1' is no instance index"},
      {"a @ all#99999999999", "no instance index"},
      {"a ; ; b", "at 4: nothing beside ';'"},
      {"a;", "at 3: nothing beside ';'"},
      {"a @ all ; b/( @ all", "at 13: name pattern '(' is no regular expression: missing )"},
      {"a @ all, sometimes", "at 10: "},
      {"x/\\Qa.b\\E", "quotes by"},
      {"x/a\\", "no regular expression"},
      {"x/(a{1000}){1000}", "no regular expression"},
      {"x/(\\pL{200}\\pN{200}){4}", "pattern too large"},
      {"a/\xff", "no UTF-8"}};
  for (const auto& [text, part] : cases) {
    EXPECT_FAILS(Query::parse(text), StatusCode::kInvalidArgument, part);
    EXPECT_FAILS(Query::parse(text), StatusCode::kInvalidArgument, std::string("query '") + text);
  }
}

TEST(Query, UnitesSelectorsAndBranches) {
  const auto query =
      Query::parse("a/b/c/d @ latest, all#2#0#2 ; a/b/x.*/d ; a/b/c/d @ latest:1, after:5");
  ASSERT_OK(query);
  ASSERT_EQ(query->memories().size(), 1u);
  const auto& providers = query->memories()[0].below[0].below;
  ASSERT_EQ(providers.size(), 2u);
  const std::vector<SnapshotQuery> expected{
      {select::Latest{}, {}}, {select::All{}, {0, 2}}, {select::After{time_from_ns(5)}, {}}};
  EXPECT_EQ(providers[0].below[0].below, expected);
  EXPECT_EQ(query->snapshots_of(*MemoryId::parse("a/b/c/d")), expected);
  EXPECT_EQ(query->snapshots_of(*MemoryId::parse("a/b/xc/d")),
            std::vector<SnapshotQuery>{SnapshotQuery{}});
  EXPECT_TRUE(query->snapshots_of(*MemoryId::parse("a/b/y/d")).empty());
  EXPECT_EQ(query->to_string(),
            "a/b/c/d @ latest, all#0#2, after:1970-01-01 00:00:00.000000005 ; a/b/x.*/d @ latest");
}

TEST(Query, AllInstancesAbsorbSingleOnes) {
  for (const char* text : {"a @ all, all#1", "a @ all#1, all", "a @ all#1 ; a @ all"})
    EXPECT_EQ(Query::parse(text)->to_string(), "a/.*/.*/.* @ all") << text;
  const auto query = *Query::parse("a/b/c/d @ all#1 ; a/b/c/.* @ all#4#0");
  EXPECT_EQ(query.snapshots_of(*MemoryId::parse("a/b/c/d")),
            (std::vector<SnapshotQuery>{{select::All{}, {0, 1, 4}}}));
}

TEST(Query, AsksForIdsOnly) {
  const auto query = Query::parse("?ids a @ all");
  ASSERT_OK(query);
  EXPECT_TRUE(query->is_ids_only());
  EXPECT_EQ(query->to_string(), "?ids a/.*/.*/.* @ all");
  EXPECT_TRUE(Query::parse("?ids")->is_ids_only());
  EXPECT_FALSE(Query::parse("\\?ids a @ all")->is_ids_only());
  EXPECT_TRUE(Query::parse("\\?ids a @ all")->matches(*MemoryId::parse("?ids a")));
}

TEST(Query, ReadsBackEveryTree) {
  RandomValues random(24);
  for (int i = 0; i < 10000; ++i) {
    const auto query = Query::create(random_query_tree(random), random.below(2) == 0);
    ASSERT_OK(query);
    const auto read = Query::parse(query->to_string());
    ASSERT_OK(read);
    ASSERT_EQ(*read, *query) << query->to_string();
    EXPECT_EQ(read->to_string(), query->to_string());
    EXPECT_EQ(*Query::from_data(query->to_data()), *query);
    // Normal form: a tree that was made of it is the same.
    EXPECT_EQ(*Query::create(query->memories(), query->is_ids_only()), *query);
  }
}

TEST(Query, AsksTheSameAsTheTreeItWasMadeOf) {
  RandomValues random(25);
  for (int i = 0; i < 2000; ++i) {
    const auto tree = random_query_tree(random);
    const Query query = *Query::create(tree);
    const MemoryId entity = random_entity(random);
    bool is_meant = false;
    for (const auto& memory : tree)
      for (const auto& core : memory.below)
        for (const auto& provider : core.below)
          for (const auto& one : provider.below)
            is_meant = is_meant || (memory.name.matches(entity.names()[0]) &&
                                    core.name.matches(entity.names()[1]) &&
                                    provider.name.matches(entity.names()[2]) &&
                                    one.name.matches(entity.names()[3]));
    EXPECT_EQ(query.matches(entity), is_meant);
    EXPECT_EQ(!query.snapshots_of(entity).empty(), is_meant);
    if (is_meant) {
      EXPECT_TRUE(query.matches(entity.parent().parent()));
    }
  }
}

TEST(Query, RefusesTreesThatAskNothingOrTooMuch) {
  const auto tree = [](std::vector<SnapshotQuery> snapshots) {
    return std::vector<MemoryQuery>{{{}, {{{}, {{{}, {{{}, std::move(snapshots)}}}}}}}};
  };
  EXPECT_OK(Query::create(tree({SnapshotQuery{}})));
  EXPECT_FAILS(Query::create({}), StatusCode::kInvalidArgument, "level 1 has no names");
  EXPECT_FAILS(Query::create({{{}, {{{}, {}}}}}), StatusCode::kInvalidArgument, "level 3");
  EXPECT_FAILS(Query::create(tree({})), StatusCode::kInvalidArgument, "'.*' has no selector");
  EXPECT_FAILS(Query::create(tree({{select::Latest{0}, {}}})), StatusCode::kInvalidArgument,
               "above zero");
  EXPECT_FAILS(Query::create(tree({{select::All{}, {-1}}})), StatusCode::kInvalidArgument,
               "-1 is no instance index");
  EXPECT_FAILS(Query::create(tree(std::vector<SnapshotQuery>(1025))),
               StatusCode::kInvalidArgument, "more than 1024 selectors");
  std::string expressions = "x0.*";
  for (int i = 1; i < 300; ++i) expressions += fmt::format(" ; x{}.*", i);
  EXPECT_FAILS(Query::parse(expressions), StatusCode::kInvalidArgument,
               "more than 256 regular expressions");
  EXPECT_FAILS(Query::from_data(7), StatusCode::kInvalidArgument, "found int32");
}

TEST(Query, MatchesEntitiesByLiteralAndExpression) {
  const MemoryId entity = *MemoryId::from_names({"Vision", "RGB", "head/left", "cam.1"});
  for (const char* text :
       {"", "Vision", "Vision/RGB", "V.*n/RGB|Depth/.*/.*", "Vision/RGB/head\\/left",
        "Vision/RGB/.*/cam.1", "Vision/RGB/.*/cam\\.1", ".*/.*/.*/cam.[0-9]"})
    EXPECT_TRUE(Query::parse(text)->matches(entity)) << text;
  for (const char* text : {"vision", "Visio", "isio.", "Vision/RG", "Vision/RGB/head",
                           ".*/.*/.*/cam", "Vision/RGB/.*/cam\\.2"})
    EXPECT_FALSE(Query::parse(text)->matches(entity)) << text;
}

TEST(Query, OfOneEntityMatchesItAlone) {
  RandomValues random(23);
  for (int i = 0; i < 500; ++i) {
    std::vector<std::string> names;
    for (int k = 0; k < 4; ++k) names.push_back("(x @ y.*" + random.text());
    const MemoryId entity = *MemoryId::from_names(names);
    const Query query = Query::of_entity(entity, select::All{});
    EXPECT_TRUE(query.matches(entity));
    names[2] += "z";
    EXPECT_FALSE(query.matches(*MemoryId::from_names(names)));
    const auto read = Query::parse(query.to_string());
    ASSERT_OK(read);
    EXPECT_TRUE(read->matches(entity)) << query.to_string();
  }
}

}  // namespace
}  // namespace engram::ltm
