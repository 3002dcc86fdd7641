// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/filter_chain.h"

#include "tests/ltm/filter/candidates.h"

namespace engram::ltm {
namespace {

std::vector<double> seconds_of(const FilterChain::Output& output) {
  std::vector<double> seconds;
  for (const Candidate& each : output.kept)
    seconds.push_back(to_seconds(each.snapshot.time - at_second(0)));
  return seconds;
}

EventRule trigger() {
  return {*EntityPattern::parse("a/b/c/event"), "", 0, Crossing::kRising};
}

TEST(FilterChain, KeepsAllWithoutFilters) {
  auto chain = *FilterChain::create({});
  FilterChain::Output output;
  for (int i = 0; i < 5; ++i) chain.offer(candidate(i), output);
  EXPECT_TRUE(chain.empty());
  EXPECT_EQ(output.kept.size(), 5u);
}

TEST(FilterChain, CountsAtEachFilterWhatThoseBeforeItKeep) {
  auto chain =
      *FilterChain::create({FrequencyFilter::Options{.max_rate_hz = 5}, EqualityFilter::Options{}});
  FilterChain::Output output;
  const uint64_t bytes = candidate(0, 1).raw_bytes;
  for (int i = 0; i < 100; ++i) chain.offer(candidate(i / 10.0, i < 50 ? 1 : 2), output);
  const auto counters = chain.counters();
  ASSERT_EQ(counters.size(), 2u);
  EXPECT_EQ(counters[0].filter, "frequency");
  EXPECT_EQ(counters[0].offered, 100u);
  EXPECT_EQ(counters[0].offered_bytes, 100 * bytes);
  EXPECT_EQ(counters[0].kept, 50u);
  EXPECT_EQ(counters[0].dropped_by.at("rate"), 50u);
  EXPECT_EQ(counters[0].dropped_bytes, 50 * bytes);
  EXPECT_EQ(counters[1].offered, 50u);
  EXPECT_EQ(counters[1].kept, 2u);
  EXPECT_EQ(counters[1].dropped_by.at("equal"), 48u);
  EXPECT_EQ(output.dropped, 98u);
  EXPECT_EQ(output.dropped_bytes, 98 * bytes);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0, 5}));
}

TEST(FilterChain, PassesOnWhatAFilterLetsGoLater) {
  auto chain = *FilterChain::create(
      {TriggerFilter::Options{.events = {trigger()}, .before = std::chrono::seconds(10)},
       FrequencyFilter::Options{.max_rate_hz = 1}});
  EXPECT_TRUE(chain.listens_to(filtered_entity("event")));
  FilterChain::Output output;
  for (int i = 0; i < 10; ++i) chain.offer(candidate(i / 2.0), output);
  EXPECT_EQ(chain.held().snapshots, 10u);
  EXPECT_TRUE(output.kept.empty());
  chain.notice(candidate(5, idf::None{}, "event").snapshot, {}, output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0, 1, 2, 3, 4}));
  EXPECT_EQ(chain.held().snapshots, 0u);
  EXPECT_EQ(output.dropped, 5u);
}

TEST(FilterChain, FlushesThroughTheFiltersBehind) {
  ImportanceFilter::Options importance{.events = {trigger()}, .base_rate_hz = 100.0};
  auto chain = *FilterChain::create(
      {EqualityFilter::Options{}, importance, FrequencyFilter::Options{.max_rate_hz = 1}});
  FilterChain::Output output;
  for (int i = 0; i < 4; ++i) chain.offer(candidate(i / 2.0, i), output);
  chain.flush(output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0, 1}));
  EXPECT_EQ(output.dropped, 2u);
}

void expect_equal(const FilterChain& a, const FilterChain& b) {
  const auto left = a.counters(), right = b.counters();
  ASSERT_EQ(left.size(), right.size());
  for (size_t i = 0; i < left.size(); ++i) {
    EXPECT_EQ(left[i].offered, right[i].offered);
    EXPECT_EQ(left[i].offered_bytes, right[i].offered_bytes);
    EXPECT_EQ(left[i].kept, right[i].kept);
    EXPECT_EQ(left[i].dropped_bytes, right[i].dropped_bytes);
    EXPECT_EQ(left[i].dropped_by, right[i].dropped_by);
  }
  EXPECT_EQ(a.late(), b.late());
}

TEST(FilterChain, DropsUnmadeWhatItWouldDropMade) {
  const auto make = [] {
    return *FilterChain::create(
        {FrequencyFilter::Options{.max_rate_hz = 2}, EqualityFilter::Options{}});
  };
  FilterChain all = make(), asked = make();
  FilterChain::Output of_all, of_asked;
  int unmade = 0;
  // Some come late, and in the end the clock is set back.
  for (int i = 0; i < 400; ++i) {
    const double second = i < 300 ? i / 10.0 - (i % 17 == 0 ? 3 : 0) : (i - 300) / 10.0;
    const Candidate made = candidate(second, i / 40);
    all.offer(made, of_all);
    const bool is_dropped = asked.drop_at(made.snapshot.time, made.raw_bytes, of_asked);
    unmade += is_dropped ? 1 : 0;
    if (!is_dropped) asked.offer(made, of_asked);
  }
  EXPECT_GT(unmade, 200);
  EXPECT_EQ(seconds_of(of_asked), seconds_of(of_all));
  EXPECT_EQ(of_asked.dropped, of_all.dropped);
  EXPECT_EQ(of_asked.dropped_bytes, of_all.dropped_bytes);
  expect_equal(asked, all);
}

TEST(FilterChain, DropsNothingUnmadeWhereValuesDecideFirst) {
  auto chain =
      *FilterChain::create({EqualityFilter::Options{}, FrequencyFilter::Options{.max_rate_hz = 1}});
  FilterChain::Output output;
  chain.offer(candidate(0), output);
  EXPECT_FALSE(chain.drop_at(at_second(0.1), 1, output));
  EXPECT_FALSE(FilterChain::create({})->drop_at(at_second(0), 1, output));
  EXPECT_EQ(output.dropped, 0u);
  EXPECT_EQ(chain.counters()[0].offered, 1u);
}

TEST(FilterChain, LetsLateSnapshotsPass) {
  auto chain = *FilterChain::create({FrequencyFilter::Options{.max_rate_hz = 1}});
  FilterChain::Output output;
  for (const double second : {0.0, 10.0, 3.0, 3.0, 10.0, 10.5, 11.0})
    chain.offer(candidate(second), output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0, 10, 3, 3, 10, 11}));
  EXPECT_EQ(chain.late(), 3u);
  EXPECT_EQ(chain.counters()[0].offered, 4u);
}

TEST(FilterChain, FiltersAgainWhereTheClockWasSetBack) {
  auto chain = *FilterChain::create({FrequencyFilter::Options{.max_rate_hz = 1}});
  FilterChain::Output output;
  chain.offer(candidate(1000), output);
  for (int i = 0; i < 100; ++i) chain.offer(candidate(i / 10.0), output);
  EXPECT_EQ(chain.late(), static_cast<uint64_t>(FilterChain::kLateOfNewClock - 1));
  EXPECT_EQ(output.kept.size(), 1u + FilterChain::kLateOfNewClock - 1 + 10);
  const FilterCounters counters = chain.counters()[0];
  EXPECT_EQ(counters.offered, counters.kept + counters.dropped());
}

TEST(FilterChain, ComparesWithNothingThatWasForgotten) {
  auto chain = *FilterChain::create({EqualityFilter::Options{}});
  FilterChain::Output output;
  chain.offer(candidate(0, 1), output);
  chain.offer(candidate(1, 1), output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0}));
  chain.forget({at_second(0)}, output);
  chain.offer(candidate(2, 1), output);
  chain.offer(candidate(3, 1), output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0, 2}));
}

TEST(FilterChain, ForgetsWhatIsHeldAndLetsTheRestFollow) {
  auto chain = *FilterChain::create(
      {TriggerFilter::Options{.events = {trigger()}, .before = std::chrono::seconds(10)}});
  FilterChain::Output output;
  for (int i = 0; i < 5; ++i) chain.offer(candidate(i), output);
  TimeSet held;
  chain.add_held_times(held);
  EXPECT_EQ(held.size(), 5u);
  chain.forget({at_second(1), at_second(3)}, output);
  EXPECT_EQ(output.dropped, 2u);
  EXPECT_EQ(chain.held().snapshots, 3u);
  EXPECT_EQ(chain.counters()[0].dropped_by.at("forgotten"), 2u);
  chain.notice(candidate(5, idf::None{}, "event").snapshot, {}, output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0, 2, 4}));
}

constexpr LinkedBuffer::Options kTenSeconds{.keeps = std::chrono::seconds(10)};

uint64_t balance_of(const FilterCounters& counters) {
  return counters.kept + counters.dropped() + counters.held.snapshots;
}

TEST(FilterChain, KeepsWhatItDroppedOnceSomethingLinksToIt) {
  auto chain = *FilterChain::create({FrequencyFilter::Options{.max_rate_hz = 1}}, kTenSeconds);
  FilterChain::Output output;
  for (int i = 0; i < 8; ++i) chain.offer(candidate(i / 4.0), output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0, 1}));
  EXPECT_EQ(chain.held().snapshots, 6u);
  EXPECT_EQ(output.dropped, 0u) << "it may be wanted yet";
  chain.want(at_second(0.5), output);
  chain.want(at_second(0.5), output);
  chain.want(at_second(1), output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0, 1, 0.5}));
  EXPECT_EQ(balance_of(chain.counters()[0]), 8u);
  chain.drop_unlinked(output);
  EXPECT_EQ(output.dropped, 5u);
  EXPECT_EQ(chain.counters()[0].dropped_by.at("rate"), 5u);
  EXPECT_EQ(chain.counters()[0].kept, 3u);
  EXPECT_EQ(chain.held().snapshots, 0u);
}

TEST(FilterChain, KeepsWhatSomethingLinkedToBeforeItCame) {
  auto chain = *FilterChain::create(
      {FrequencyFilter::Options{.max_rate_hz = 1}, EqualityFilter::Options{}}, kTenSeconds);
  FilterChain::Output output;
  chain.want(at_second(0.5), output);
  chain.want(at_second(2), output);
  for (int i = 0; i < 10; ++i) chain.offer(candidate(i / 4.0), output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0, 0.5, 2}))
      << "one that the rate dropped, and one that was equal";
  EXPECT_EQ(balance_of(chain.counters()[0]), 10u);
  EXPECT_EQ(balance_of(chain.counters()[1]), chain.counters()[1].offered);
}

TEST(FilterChain, GivesUpWhatNothingLinkedTo) {
  auto chain = *FilterChain::create({FrequencyFilter::Options{.max_rate_hz = 0.01}}, kTenSeconds);
  FilterChain::Output output;
  for (int i = 0; i <= 20; ++i) chain.offer(candidate(i), output);
  EXPECT_EQ(output.dropped, 9u);
  chain.want(at_second(9), output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0})) << "too late";
  chain.want(at_second(10), output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0, 10}));
  EXPECT_EQ(balance_of(chain.counters()[0]), 21u);
}

TEST(FilterChain, HoldsNoMoreBytesThanItMayForWhatMayBeLinkedTo) {
  auto chain = *FilterChain::create({FrequencyFilter::Options{.max_rate_hz = 0.01}},
                                    LinkedBuffer::Options{kTenSeconds.keeps, 100'000});
  FilterChain::Output output;
  for (int i = 0; i < 50; ++i) chain.offer(candidate(i / 10.0, std::string(10'000, 'x')), output);
  EXPECT_LE(chain.held().bytes, 110'000u) << "the last one comes on top";
  EXPECT_GE(chain.held().snapshots, 9u);
  EXPECT_EQ(output.kept.size() + output.dropped + chain.held().snapshots, 50u);
}

TEST(FilterChain, ForgetsWhatMayBeLinkedTo) {
  auto chain = *FilterChain::create({FrequencyFilter::Options{.max_rate_hz = 0.01}}, kTenSeconds);
  FilterChain::Output output;
  for (int i = 0; i < 4; ++i) chain.offer(candidate(i), output);
  TimeSet held;
  chain.add_held_times(held);
  EXPECT_EQ(held.size(), 3u);
  TimeSet gone;
  gone.insert(at_second(2));
  chain.forget(gone, output);
  EXPECT_EQ(chain.counters()[0].dropped_by.at(std::string(Filter::kForgotten)), 1u);
  chain.want(at_second(2), output);
  EXPECT_EQ(seconds_of(output), (std::vector<double>{0}));
}

TEST(FilterChain, RefusesOptionsThatDoNotValidate) {
  EXPECT_FAILS(FilterChain::create({FrequencyFilter::Options{.max_rate_hz = 0}}),
               StatusCode::kInvalidArgument, "0 Hz");
}

}  // namespace
}  // namespace engram::ltm
