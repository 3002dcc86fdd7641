// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/select.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace engram::ltm {
namespace {

Time t(int64_t ns) {
  return time_from_ns(ns);
}

struct Case {
  Selector selector;
  size_t first;
  size_t count;
  std::optional<int64_t> future = {};
};

void expect_cases(const std::vector<Time>& times, const std::vector<Case>& cases) {
  ListedMoments moments(times);
  for (size_t i = 0; i < cases.size(); ++i) {
    Selection expected;
    if (cases[i].count > 0)
      expected.snapshots = {times[cases[i].first], times[cases[i].first + cases[i].count - 1]};
    if (cases[i].future) expected.future = t(*cases[i].future);
    const auto found = select_times(cases[i].selector, moments);
    ASSERT_TRUE(found.ok());
    EXPECT_EQ(*found, expected) << "case " << i;
  }
}

TEST(SelectTimes, AppliesEachSelector) {
  const std::vector<Time> times{t(10), t(20), t(30), t(40)};
  expect_cases(times, {{select::All{}, 0, 4},
                       {select::Latest{}, 3, 1},
                       {select::Latest{3}, 1, 3},
                       {select::Latest{INT64_MAX}, 0, 4},
                       {select::Latest{0}, 0, 0},
                       {select::At{t(20)}, 1, 1},
                       {select::At{t(21)}, 0, 0},
                       {select::At{t(5)}, 0, 0},
                       {select::At{t(40)}, 3, 1},
                       {select::At{t(41)}, 0, 0, 41},
                       {select::Ahead{Duration(5)}, 0, 0, 45},
                       {select::Ahead{Duration(0)}, 3, 1},
                       {select::Ahead{Duration(-10)}, 2, 1},
                       {select::Ahead{Duration(-11)}, 0, 0},
                       {select::Nearest{t(24)}, 1, 1},
                       {select::Nearest{t(26)}, 2, 1},
                       {select::Nearest{t(25)}, 1, 1},
                       {select::Nearest{t(30)}, 2, 1},
                       {select::Nearest{t(-100)}, 0, 1},
                       {select::Nearest{t(1000)}, 3, 1},
                       {select::Nearest{t(24), Duration(4)}, 1, 1},
                       {select::Nearest{t(24), Duration(3)}, 0, 0},
                       {select::Nearest{t(50), Duration(9)}, 0, 0},
                       {select::Nearest{t(30), Duration(0)}, 2, 1},
                       {select::Before{t(20), false}, 0, 1},
                       {select::Before{t(20), true}, 1, 1},
                       {select::Before{t(10), false}, 0, 0},
                       {select::Before{t(10), true}, 0, 1},
                       {select::Before{t(99), false}, 3, 1},
                       {select::After{t(20)}, 2, 1},
                       {select::After{t(0)}, 0, 1},
                       {select::After{t(40)}, 0, 0},
                       {select::TimeRange{t(20), t(30)}, 1, 2},
                       {select::TimeRange{t(11), t(19)}, 0, 0},
                       {select::TimeRange{t(0), t(99)}, 0, 4},
                       {select::TimeRange{t(41), t(99)}, 0, 0},
                       {select::TimeRange{t(30), t(20)}, 0, 0},
                       {select::LastDuration{Duration(10)}, 2, 2},
                       {select::LastDuration{Duration(0)}, 3, 1},
                       {select::LastDuration{Duration(999)}, 0, 4},
                       {select::IndexRange{1, 2}, 1, 2},
                       {select::IndexRange{-2, -1}, 2, 2},
                       {select::IndexRange{0, 99}, 0, 4},
                       {select::IndexRange{-99, -4}, 0, 1},
                       {select::IndexRange{2, 1}, 0, 0},
                       {select::IndexRange{4, 9}, 0, 0},
                       {select::IndexRange{-99, -9}, 0, 0}});
}

TEST(SelectTimes, OfAnEntityWithoutSnapshotsIsEmpty) {
  expect_cases({}, {{select::All{}, 0, 0},
                    {select::Latest{5}, 0, 0},
                    {select::At{t(5)}, 0, 0},
                    {select::Ahead{Duration(5)}, 0, 0},
                    {select::Nearest{t(5)}, 0, 0},
                    {select::Before{t(5), true}, 0, 0},
                    {select::After{t(5)}, 0, 0},
                    {select::TimeRange{t(0), t(9)}, 0, 0},
                    {select::LastDuration{Duration(5)}, 0, 0},
                    {select::IndexRange{0, -1}, 0, 0}});
}

TEST(SelectTimes, KnowsTheLimitsOfTime) {
  const std::vector<Time> times{t(INT64_MIN), t(0), t(INT64_MAX - 5)};
  expect_cases(times, {{select::Ahead{Duration(INT64_MAX)}, 0, 0, INT64_MAX},
                       {select::Nearest{t(INT64_MIN + 1)}, 0, 1},
                       {select::Nearest{t(INT64_MAX)}, 2, 1},
                       {select::Nearest{t(INT64_MIN / 2 - 2)}, 0, 1},
                       {select::LastDuration{Duration(INT64_MAX)}, 1, 2},
                       {select::TimeRange{t(INT64_MIN), t(INT64_MAX)}, 0, 3},
                       {select::IndexRange{INT64_MIN, INT64_MAX}, 0, 3}});
  expect_cases({t(INT64_MIN), t(INT64_MIN + 9)}, {{select::LastDuration{Duration(INT64_MAX)}, 0, 2},
                                                  {select::Ahead{Duration(INT64_MIN)}, 0, 1},
                                                  {select::Nearest{t(INT64_MAX)}, 1, 1}});
}

TEST(SelectSnapshots, UnitesInTheOrderOfTime) {
  ListedMoments times({t(10), t(20), t(30), t(40)});
  const std::vector<SnapshotQuery> queries{
      {select::Latest{2}, {1}},           {select::Ahead{Duration(5)}, {}},
      {select::IndexRange{0, 2}, {0, 2}}, {select::At{t(45)}, {3}},
      {select::At{t(41)}, {3}},           {select::Before{t(20), false}, {}}};
  const std::vector<SelectedSnapshot> expected{{t(10), false, {}},        {t(20), false, {0, 2}},
                                               {t(30), false, {0, 1, 2}}, {t(40), false, {1}},
                                               {t(41), true, {3}},        {t(45), true, {}}};
  EXPECT_EQ(*select_snapshots(queries, times), expected);
  EXPECT_TRUE(select_snapshots({}, times)->empty());
  ListedMoments none({});
  EXPECT_TRUE(select_snapshots(queries, none)->empty());
}

TEST(SelectSnapshots, OfOneSelectorAreItsOwn) {
  ListedMoments times({t(10), t(20), t(30)});
  const std::vector<SnapshotQuery> queries{{select::Latest{2}, {4}}};
  EXPECT_EQ(*select_snapshots(queries, times),
            (std::vector<SelectedSnapshot>{{t(20), false, {4}}, {t(30), false, {4}}}));
}

TEST(SelectedMoments, AreThoseOfTheList) {
  ListedMoments times({t(10), t(20), t(30), t(40)});
  const std::vector<SnapshotQuery> queries{{select::Latest{2}, {1}},
                                           {select::IndexRange{0, 2}, {}},
                                           {select::TimeRange{t(15), t(30)}, {0}},
                                           {select::At{t(45)}, {2}},
                                           {select::Ahead{Duration(1)}, {}},
                                           {select::Before{t(5), false}, {}}};
  for (size_t first = 0; first < queries.size(); ++first)
    for (size_t count = 0; first + count <= queries.size(); ++count) {
      const auto some = std::span(queries).subspan(first, count);
      const auto moments = SelectedMoments::create(some, times);
      ASSERT_TRUE(moments.ok());
      std::vector<SelectedSnapshot> found;
      std::optional<Time> last;
      while (true) {
        const auto next = moments->after(last, times);
        ASSERT_TRUE(next.ok());
        if (!*next) break;
        last = (*next)->time;
        found.push_back(**next);
      }
      found.insert(found.end(), moments->future().begin(), moments->future().end());
      EXPECT_EQ(found, *select_snapshots(some, times)) << first << " " << count;
    }
}

TEST(SelectedMoments, AreSettledWhenTheyAreCreated) {
  ListedMoments times({t(10), t(20), t(30)});
  const std::vector<SnapshotQuery> queries{{select::Latest{2}, {}}};
  const auto moments = SelectedMoments::create(queries, times);
  ASSERT_TRUE(moments.ok());
  ListedMoments later({t(10), t(25), t(30), t(40), t(50)});
  EXPECT_EQ((*moments->after({}, later))->time, t(25)) << "the one at 20 has gone";
  EXPECT_EQ((*moments->after(t(25), later))->time, t(30));
  EXPECT_FALSE(moments->after(t(30), later)->has_value());
}

}  // namespace
}  // namespace engram::ltm
