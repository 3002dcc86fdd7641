// SPDX-License-Identifier: Apache-2.0
// What every filter promises, whatever it looks for.
#include <limits>
#include <set>

#include "ltm/filter/filter_chain.h"
#include "tests/ltm/filter/candidates.h"
#include "tests/ltm/random_types.h"

namespace engram::ltm {
namespace {

struct Member {
  std::string name;
  FilterOptions options;
};

EventRule crossing() {
  return {std::nullopt, "x", 0.5, Crossing::kEither};
}
EventRule other() {
  return {*EntityPattern::parse("a/b/c/event"), "", 0, Crossing::kRising};
}

const std::vector<Member>& members() {
  static const std::vector<Member> all{
      {"frequency", FrequencyFilter::Options{.max_rate_hz = 3}},
      {"equality", EqualityFilter::Options{.max_gap = std::chrono::seconds(5)}},
      {"similarity", SimilarityFilter::Options{.numbers = {Measure::kRms, 0.3}}},
      {"similarityByCosine", SimilarityFilter::Options{.images = {Measure::kMse, 10},
                                                       .numbers = {Measure::kCosine, 0.5},
                                                       .compares_remainder = false}},
      {"importance", ImportanceFilter::Options{.events = {crossing(), other()},
                                               .before = std::chrono::seconds(1),
                                               .after = std::chrono::milliseconds(500)}},
      {"importanceWithBaseRate", ImportanceFilter::Options{.events = {crossing(), other()},
                                                           .before = std::chrono::milliseconds(100),
                                                           .after = std::chrono::milliseconds(100),
                                                           .base_rate_hz = 1.0,
                                                           .max_held_bytes = 1 << 14}},
      {"trigger", TriggerFilter::Options{.events = {other()},
                                         .before = std::chrono::seconds(2),
                                         .after = std::chrono::milliseconds(100)}},
  };
  return all;
}

/// Values of every kind, some of them again, with types for some.
std::vector<Candidate> made_up(uint64_t seed) {
  RandomTypes random(seed);
  const idf::Type type = random.type(2);
  std::vector<Candidate> made;
  double second = 0;
  for (int i = 0; i < 300; ++i) {
    second += 0.01 + static_cast<double>(random.values().below(40)) / 100;
    idf::Data value;
    switch (random.values().below(6)) {
      case 0:
        value = random.values().value(3);
        break;
      case 1:
        value = random.value_of(type);
        break;
      case 2:
        value = made.empty() ? idf::Data(1.0) : made.back().snapshot.instances.front().data;
        break;
      case 3:
        value = idf::Dict{{"x", std::numeric_limits<double>::quiet_NaN()}};
        break;
      case 4:
        value = idf::Dict{{"x", idf::NdArray::take<float>({0, 3}, {})}};
        break;
      default:
        value = idf::Dict{{"x", static_cast<double>(random.values().below(4)) / 4}};
    }
    made.push_back(candidate(second, std::move(value)));
    if (random.chance(3)) made.back().type = type;
    if (random.chance(9)) made.back().snapshot.instances.push_back({idf::Data(7), {}});
  }
  return made;
}

class FilterConformance : public ::testing::TestWithParam<size_t> {
 protected:
  [[nodiscard]] std::unique_ptr<Filter> make() const {
    return *make_filter(members()[GetParam()].options);
  }

  /// Offers all, with events in between, and a flush in the end.
  static FilterDecisions run(Filter& filter, const std::vector<Candidate>& offered) {
    FilterDecisions decisions;
    uint64_t count = 0;
    for (const Candidate& each : offered) {
      filter.offer(each, decisions);
      expect_balance(filter, decisions, ++count);
      if (count % 50 == 0) {
        Candidate event = candidate(0, idf::None{}, "event");
        event.snapshot.time = each.snapshot.time;
        filter.notice(event.snapshot, event.type, decisions);
        expect_balance(filter, decisions, count);
      }
    }
    filter.flush(decisions);
    EXPECT_EQ(filter.held().snapshots, 0u);
    EXPECT_EQ(filter.held().bytes, 0u);
    expect_balance(filter, decisions, count);
    return decisions;
  }

  static void expect_balance(const Filter& filter, const FilterDecisions& decisions,
                             uint64_t offered) {
    ASSERT_EQ(decisions.kept.size() + decisions.dropped.size() + filter.held().snapshots, offered);
  }
};

TEST_P(FilterConformance, ForgetsWhatItHoldsOfTheseTimesAndKeepsNoneOfIt) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto filter = make();
    FilterDecisions decisions;
    const std::vector<Candidate> offered = made_up(seed);
    for (const Candidate& each : offered) filter->offer(each, decisions);
    TimeSet held;
    filter->add_held_times(held);
    ASSERT_EQ(held.size(), filter->held().snapshots);
    TimeSet gone;
    for (size_t i = 0; i < offered.size(); i += 2) gone.insert(offered[i].snapshot.time);
    FilterDecisions forgetting;
    const bool goes_on = filter->forget(gone, forgetting);
    EXPECT_TRUE(forgetting.kept.empty());
    for (const FilterDecisions::Drop& drop : forgetting.dropped)
      EXPECT_EQ(drop.reason, Filter::kForgotten);
    TimeSet left;
    filter->add_held_times(left);
    EXPECT_EQ(left.size() + forgetting.dropped.size(), held.size());
    for (const Time time : left) EXPECT_FALSE(gone.contains(time));
    // One that holds nothing is replaced instead.
    EXPECT_TRUE(goes_on || left.empty());
    FilterDecisions rest;
    filter->flush(rest);
    for (const Candidate& kept : rest.kept) EXPECT_FALSE(gone.contains(kept.snapshot.time));
    EXPECT_EQ(filter->held().bytes, 0u);
  }
}

TEST_P(FilterConformance, IsDeterministicKeepsOrderAndCountsEverything) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<Candidate> offered = made_up(seed);
    const auto first = make(), second = make();
    const FilterDecisions a = run(*first, offered), b = run(*second, offered);
    ASSERT_EQ(a.kept.size(), b.kept.size());
    auto next = offered.begin();
    for (size_t i = 0; i < a.kept.size(); ++i) {
      EXPECT_EQ(a.kept[i].snapshot, b.kept[i].snapshot);
      // In the order of what was offered, each at most once, and unchanged.
      while (next != offered.end() && next->snapshot.time != a.kept[i].snapshot.time) ++next;
      ASSERT_NE(next, offered.end());
      EXPECT_EQ(a.kept[i].snapshot, next->snapshot);
      EXPECT_EQ(a.kept[i].raw_bytes, next->raw_bytes);
      ++next;
    }
    EXPECT_FALSE(a.kept.empty());
    EXPECT_FALSE(a.dropped.empty());
    for (const auto& drop : a.dropped) EXPECT_FALSE(drop.reason.empty());
  }
}

TEST_P(FilterConformance, TakesNothingOneAndTheHuge) {
  const auto none = make();
  FilterDecisions decisions;
  none->flush(decisions);
  EXPECT_TRUE(decisions.kept.empty() && decisions.dropped.empty());

  std::vector<uint8_t> pixels(size_t{3000} * 4000 * 3, 7);
  const idf::Data huge = idf::Dict{
      {"x", 0.0}, {"image", idf::NdArray::take<uint8_t>({3000, 4000, 3}, std::move(pixels))}};
  const auto filter = make();
  const FilterDecisions two = run(*filter, {candidate(0, huge), candidate(0.1, huge)});
  EXPECT_EQ(two.kept.size() + two.dropped.size(), 2u);
  const auto one = make();
  const FilterDecisions single = run(*one, {candidate(0, 1.0)});
  EXPECT_EQ(single.kept.size() + single.dropped.size(), 1u);
}

TEST_P(FilterConformance, TakesTimesAtTheEndsOfTheirRange) {
  const auto filter = make();
  std::vector<Candidate> ends;
  for (const Time time : {Time::min(), Time::min() + Duration(1), Time{}, Time::max()}) {
    ends.push_back(candidate(0, idf::Dict{{"x", 0.0}}));
    ends.back().snapshot.time = time;
  }
  run(*filter, ends);
}

INSTANTIATE_TEST_SUITE_P(All, FilterConformance, ::testing::Range<size_t>(0, members().size()),
                         [](const auto& test) { return members()[test.param].name; });

TEST(FilterRegistry, HasEveryFilterInTheSuiteUnderItsName) {
  std::set<std::string_view> seen;
  for (const Member& member : members()) {
    const auto filter = *make_filter(member.options);
    EXPECT_EQ(filter->name(), all_filters()[member.options.index()]);
    EXPECT_TRUE(member.name.starts_with(filter->name()));
    seen.insert(filter->name());
  }
  EXPECT_EQ(seen.size(), all_filters().size());
}

}  // namespace
}  // namespace engram::ltm
