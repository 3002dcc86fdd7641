// SPDX-License-Identifier: Apache-2.0
// Each policy by itself, through a rule.
#include "ltm/forgetting/forget_options.h"
#include "ltm/saliency/make_saliency.h"
#include "tests/ltm/forgetting/forget_fixture.h"

namespace engram::ltm {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Seconds = std::chrono::seconds;

class Policies : public ForgetFixture {
 protected:
  static ForgetOptions only(ForgetRule rule) {
    ForgetOptions options;
    options.protection.newest = 0;
    options.rules = {std::move(rule)};
    return options;
  }
  static ForgetRule importance(const std::string& path, std::optional<double> below) {
    ForgetRule rule;
    rule.importance = ImportancePolicy::Options{path, below};
    return rule;
  }
  static ForgetRule access(std::optional<Duration> unread_for, std::optional<uint64_t> less_than) {
    ForgetRule rule;
    rule.access = UnreadPolicy::Options{unread_for, less_than};
    return rule;
  }
  static ForgetRule redundant(std::optional<Duration> max_gap, double bound = 0.5) {
    ForgetRule rule;
    rule.redundancy.emplace();
    rule.redundancy->numbers = {Measure::kMaxAbs, bound};
    rule.redundancy->max_gap = max_gap;
    return rule;
  }
};

TEST_F(Policies, AgeTakesWhatIsOlderAndNotWhatIsExactlyAsOld) {
  seal_numbers("cam", 0, 6);
  now_ = second(10);
  EXPECT_THAT(gone(plan(only(older_than(Seconds(7))))), ElementsAre(0, 1, 2));
  EXPECT_THAT(gone(plan(only(older_than(Seconds(100))))), IsEmpty());
}

TEST_F(Policies, AgeOfADurationBeyondTheRangeOfTimesTakesNothing) {
  seal_numbers("cam", 0, 3);
  EXPECT_THAT(gone(plan(only(older_than(Duration::max())))), IsEmpty());
}

TEST_F(Policies, AccessTakesWhatWasNotReadForLong) {
  seal_numbers("cam", 0, 4);
  accesses_.add(example_entity(), second(1), 5, second(990));
  accesses_.add(example_entity(), second(2), 5, second(500));
  EXPECT_THAT(gone(plan(only(access(Seconds(100), {})))), ElementsAre(0, 2, 3));
}

TEST_F(Policies, AccessTakesWhatWasReadTooSeldom) {
  seal_numbers("cam", 0, 4);
  accesses_.add(example_entity(), second(1), 3, second(500));
  accesses_.add(example_entity(), second(2), 2, second(500));
  EXPECT_THAT(gone(plan(only(access({}, 3)))), ElementsAre(0, 2, 3));
  accesses_.add(example_entity(), second(3), 1, second(999));
  EXPECT_THAT(gone(plan(only(access(Seconds(100), 3)))), ElementsAre(0, 2))
      << "both conditions have to hold";
}

TEST_F(Policies, WhatIsNewIsNotUnreadForLong) {
  seal_numbers("cam", 940, 10);
  seal_numbers("other", 0, 1);
  const auto made = plan(only(access(Seconds(100), {})));
  EXPECT_THAT(gone(made), IsEmpty());
  EXPECT_THAT(gone(made, "other"), ElementsAre(0));
}

TEST_F(Policies, ImportanceIsTheConfidenceWithoutAPath) {
  append({numbered("cam", 0, 1, 0.2F), numbered("cam", 1, 1, 0.9F), numbered("cam", 2, 1, 0.5F)});
  EXPECT_THAT(gone(plan(only(importance("", 0.5)))), ElementsAre(0));
  EXPECT_THAT(gone(plan(only(importance("", 0.6)))), ElementsAre(0, 2));
}

TEST_F(Policies, OfSeveralInstancesTheMostImportantCounts) {
  Snapshot snapshot = numbered("cam", 0, 1, 0.2F);
  snapshot.instances.push_back(numbered("cam", 0, 7, 0.9F).instances.front());
  append({snapshot});
  EXPECT_THAT(gone(plan(only(importance("", 0.5)))), IsEmpty());
  EXPECT_THAT(gone(plan(only(importance("x", 5)))), IsEmpty());
  EXPECT_THAT(gone(plan(only(importance("x", 8)))), ElementsAre(0));
}

TEST_F(Policies, ImportanceByValueLeavesWhatHasNone) {
  Snapshot text = numbered("cam", 3, 0);
  text.instances.front().data = idf::Dict{{"x", "unknown"}};
  append({numbered("cam", 0, -4), numbered("cam", 1, 4), numbered("cam", 2, std::nan("")), text});
  EXPECT_THAT(gone(plan(only(importance("x", 0)))), ElementsAre(0));
  EXPECT_THAT(gone(plan(only(importance("y", 0)))), IsEmpty());
}

TEST_F(Policies, SaliencyTakesWhatItsNeighboursTell) {
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 40; ++i) snapshots.push_back(numbered("cam", i, i < 20 ? 1 : 7));
  append(snapshots);
  ForgetRule rule;
  rule.saliency = SaliencyPolicy::Options{.below = 0.3};
  EXPECT_THAT(gone(plan(only(rule))), IsEmpty());  // No night has looked at them.
  ASSERT_OK(make_saliency(store_, {}, {}, {}, {}));
  const auto low = gone(plan(only(rule)));
  EXPECT_EQ(low.size(), 38u);
  for (const int64_t change : {0, 20}) EXPECT_THAT(low, ::testing::Not(Contains(change)));
  rule.saliency = SaliencyPolicy::Options{.keep = 0.5};
  const auto half = gone(plan(only(rule)));
  EXPECT_EQ(half.size(), 20u);
  EXPECT_THAT(half, ::testing::Not(Contains(20)));
  rule.match = *EntityPattern::parse("Vision/RGB/head/other");
  EXPECT_THAT(gone(plan(only(rule))), IsEmpty());
}

TEST_F(Policies, AQuotaTakesTheLeastSalientFirst) {
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 40; ++i) {
    snapshots.push_back(noisy("cam", i, 20'000));
    snapshots.back().instances.front().data.get_if<idf::Dict>()->set("x", i < 20 ? 1.0 : 7.0);
  }
  append(snapshots);
  ASSERT_OK(make_saliency(store_, {}, {}, {}, {}));
  ForgetOptions options;
  options.protection.newest = 0;
  options.max_bytes = context().store_bytes / 10;
  options.first.emplace_back().saliency = SaliencyPolicy::Options{};
  const auto taken = gone(plan(options));
  EXPECT_GT(taken.size(), 30u);
  EXPECT_LT(taken.size(), 39u);
  for (const int64_t change : {0, 20}) EXPECT_THAT(taken, ::testing::Not(Contains(change)));
}

TEST_F(Policies, RedundancyKeepsTheFirstOfEachRunAndOnePerGap) {
  append({numbered("cam", 0, 1.0), numbered("cam", 1, 1.1), numbered("cam", 2, 1.2),
          numbered("cam", 3, 2.0), numbered("cam", 4, 2.0), numbered("cam", 5, 2.0),
          numbered("cam", 6, 2.0)});
  EXPECT_THAT(gone(plan(only(redundant({})))), ElementsAre(1, 2, 4, 5, 6));
  EXPECT_THAT(gone(plan(only(redundant(Seconds(2))))), ElementsAre(1, 4, 6));
}

TEST_F(Policies, RedundancyComparesWithWhatStaysNotWithTheOneBefore) {
  seal_numbers("cam", 0, 7, 0.3);
  EXPECT_THAT(gone(plan(only(redundant({})))), ElementsAre(1, 3, 5));
}

TEST_F(Policies, RedundancySeesTheSameInOnePartAndInMany) {
  std::mt19937 random(7);
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 60; ++i)
    snapshots.push_back(numbered("cam", i, static_cast<double>(random() % 3)));
  append(snapshots);
  Recall recall(*StoreReader::open(store_), {});
  ForgetSource source(recall, accesses_);
  const std::vector<SnapshotEntry> all = **recall.store().index(example_entity());
  std::vector<bool> may_go;
  for (size_t i = 0; i < all.size(); ++i) may_go.push_back(random() % 3 != 0);
  const auto propose_in_parts_of = [&](size_t part) {
    const auto policy = *RedundancyPolicy::create(*redundant(Seconds(9)).redundancy);
    std::vector<size_t> proposed;
    for (size_t first = 0; first < all.size(); first += part) {
      const size_t end = std::min(first + part, all.size());
      const std::vector<bool> allowed(may_go.begin() + static_cast<ptrdiff_t>(first),
                                      may_go.begin() + static_cast<ptrdiff_t>(end));
      const auto seen = std::span(all).subspan(first, end - first);
      const auto proposals = policy->propose(source, {example_entity(), seen, allowed});
      EXPECT_OK(proposals);
      for (const ForgetProposal& each : *proposals) proposed.push_back(first + each.snapshot);
    }
    return proposed;
  };
  const auto whole = propose_in_parts_of(all.size());
  EXPECT_GT(whole.size(), 3u);
  for (const size_t part : {1, 2, 7, 59}) EXPECT_EQ(propose_in_parts_of(part), whole) << part;
}

TEST_F(Policies, RedundancyIsTakenOfWhatEarlierRulesLeave) {
  append({numbered("cam", 0, 1), numbered("cam", 1, 1), numbered("cam", 2, 1)});
  ForgetOptions options = only(older_than(Seconds(0)));
  now_ = second(1);
  options.rules.push_back(redundant({}));
  EXPECT_THAT(gone(plan(options)), ElementsAre(0, 2)) << "second 1 stays for the first";
}

TEST_F(Policies, APolicyNarrowsWhatTheOneBeforeItProposes) {
  append(
      {numbered("cam", 0, 1), numbered("cam", 1, 1), numbered("cam", 2, 1), numbered("cam", 3, 1)});
  ForgetRule rule = redundant({});
  rule.age = AgePolicy::Options{Seconds(0)};
  now_ = second(2);
  const auto made = plan(only(rule));
  EXPECT_THAT(gone(made), ElementsAre(1));
  EXPECT_EQ(made->entities.at(example_entity()).reasons.begin()->first, "older than 0s, redundant");
}

TEST_F(Policies, WhatMayNotGoIsWhatOthersAreSimilarTo) {
  append({numbered("cam", 0, 7), numbered("cam", 1, 1, 0.9F), numbered("cam", 2, 1, 0.2F),
          numbered("cam", 3, 1, 0.9F), numbered("cam", 4, 1, 0.2F), numbered("cam", 5, 3, 0.2F)});
  ForgetRule rule = redundant({});
  rule.importance = ImportancePolicy::Options{"", 0.5};
  EXPECT_THAT(gone(plan(only(rule))), ElementsAre(2, 4));
}

TEST_F(Policies, ARuleTakesOnlyTheEntitiesThatItMatches) {
  seal_numbers("cam", 0, 2);
  seal_numbers("other", 0, 2);
  ForgetRule rule = older_than(Seconds(0));
  rule.match = *EntityPattern::parse("Vision/.*/head/c.m");
  const auto made = plan(only(rule));
  EXPECT_THAT(gone(made), ElementsAre(0, 1));
  EXPECT_THAT(gone(made, "other"), IsEmpty());
}

TEST_F(Policies, ARuleWithoutAPolicyIsRefused) {
  EXPECT_FAILS(plan(only(ForgetRule())), StatusCode::kInvalidArgument, "has no policy");
  EXPECT_FAILS(plan(only(access({}, 0))), StatusCode::kInvalidArgument, "read_less_than");
}

}  // namespace
}  // namespace engram::ltm
