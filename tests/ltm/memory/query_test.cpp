// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/query.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram::ltm {
namespace {

const Time kT1 = time_from_ns(1645189616492182000);
const Time kT2 = kT1 + std::chrono::seconds(5);

Selector selector_of(const std::string& text) {
  const auto query = Query::parse("a/b/c/d @ " + text);
  EXPECT_OK(query);
  return query.ok() ? query->selector() : Selector();
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
  EXPECT_EQ(Query::parse("a/b/c/d")->selector(), Selector(select::Latest{}));
  EXPECT_EQ(*Query::parse(""), Query());
  EXPECT_EQ(*Query::parse(" @ all"), Query({}, select::All{}));
  EXPECT_EQ(Query::parse("a @all")->selector(), Selector(select::All{}));
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
      {"a @ ", "is no time"}};
  for (const auto& [text, part] : cases) {
    EXPECT_FAILS(Query::parse(text), StatusCode::kInvalidArgument, part);
    EXPECT_FAILS(Query::parse(text), StatusCode::kInvalidArgument, std::string("query '") + text);
  }
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
