// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/carry_out.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "ltm/saliency/make_saliency.h"
#include "ltm/saliency/saliency_table.h"
#include "ltm/store/night_records.h"
#include "ltm/store/publish.h"
#include "tests/ltm/forgetting/forget_fixture.h"

namespace engram::ltm {
namespace {

using Seconds = std::chrono::seconds;

class CarryOut : public ForgetFixture {
 protected:
  /// A store of a few entities in a few segments, with updates, and some that is not sealed.
  void fill(std::mt19937& random) {
    const auto below = [&random](uint32_t end) { return static_cast<int64_t>(random() % end); };
    const int64_t segments = 1 + below(4);
    for (int64_t s = 0; s <= segments; ++s) {
      std::vector<Snapshot> snapshots;
      for (int64_t i = below(20); i >= 0; --i) {
        const std::string name = below(2) == 0 ? "cam" : "other";
        snapshots.push_back(numbered(name, below(60), static_cast<double>(below(4)),
                                     static_cast<float>(below(10)) / 10));
      }
      append(snapshots, s < segments);
    }
  }

  static ForgetOptions random_options(std::mt19937& random, uint64_t store_bytes) {
    ForgetOptions options;
    options.protection.newest = random() % 3;
    if (random() % 2 == 0) options.rules.push_back(older_than(Seconds(940 + random() % 60)));
    if (random() % 2 == 0) {
      ForgetRule& rule = options.rules.emplace_back();
      rule.match = *EntityPattern::parse("Vision/RGB/head/cam");
      rule.importance = ImportancePolicy::Options{"x", static_cast<double>(random() % 4)};
    }
    if (random() % 2 == 0) options.rules.emplace_back().redundancy.emplace();
    if (random() % 3 == 0) {
      options.max_bytes = store_bytes * (random() % 100) / 100;
      options.first.emplace_back().importance = ImportancePolicy::Options{};
    }
    return options;
  }

  PlanAgain again(const ForgetOptions& options, const ForgetPlan& first) {
    return [this, quota = quota_after(options, first)](bool may_fade) mutable {
      if (!may_fade) quota.fade.clear();
      return plan(quota);
    };
  }

  /// Segments of three noisy snapshots of two entities each.
  void seal_noise(int64_t segments, size_t bytes) {
    for (int64_t s = 0; s < segments; ++s)
      append({noisy("cam", 3 * s, bytes), noisy("other", 3 * s + 1, bytes),
              noisy("cam", 3 * s + 2, bytes)});
  }
};

TEST_F(CarryOut, QuotasGoOnBySaliencyWhereTheyEnded) {
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 200; ++i) {
    snapshots.push_back(noisy("cam", i, 1500));
    const double x = i < 50 ? 1 : i < 120 ? 4 : 9;
    snapshots.back().instances.front().data.get_if<idf::Dict>()->set("x", x);
  }
  append(snapshots);
  ASSERT_OK(make_saliency(store_, {}, {}, {}, {}));
  ForgetOptions options;
  options.protection.newest = 0;
  options.first.emplace_back().saliency = SaliencyPolicy::Options{};
  const uint64_t before = *directory_bytes(store_);
  uint64_t gone = 0;
  for (const uint64_t part : {2, 4}) {
    options.max_bytes = before / part;
    const auto first = plan(options);
    ASSERT_OK(first);
    const auto report = carry_out(store_, *first, again(options, *first));
    ASSERT_OK(report);
    EXPECT_GT(report->rewritten.snapshots, 20u);
    EXPECT_LE(report->bytes_after, *options.max_bytes);
    gone += report->rewritten.snapshots;
  }
  const auto reader = *StoreReader::open(store_);
  const SaliencyTable left = SaliencyTable::read(*reader, accesses_);
  EXPECT_EQ(left.size(), 200 - gone);
  for (const int64_t change : {0, 50, 120})
    EXPECT_TRUE(left.find(example_entity(), second(change))) << change;
}

TEST_F(CarryOut, ARuleThatKeepsAShareTakesNothingWhenItRunsAgain) {
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 200; ++i) {
    snapshots.push_back(numbered("cam", i, i < 50 ? 1 : i < 120 ? 4 : 9));
  }
  append(snapshots);
  ASSERT_OK(make_saliency(store_, {}, {}, {}, {}));
  ForgetOptions options;
  options.protection.newest = 0;
  ForgetRule rule;
  rule.saliency = SaliencyPolicy::Options{.keep = 0.1};
  options.rules.push_back(rule);
  const auto first = plan(options);
  ASSERT_OK(first);
  EXPECT_NEAR(first->snapshots(), 180, 8);
  ASSERT_OK(carry_out(store_, *first, again(options, *first)));
  const auto second = plan(options);
  ASSERT_OK(second);
  EXPECT_EQ(second->snapshots(), 0u);
}

TEST_F(CarryOut, WritesDownWhatWentInAllRounds) {
  seal_noise(8, 3000);
  EXPECT_OK(carry_out(store_, *plan({}), {}));
  EXPECT_TRUE(read_nights(store_, 9)->nights.empty());
  ForgetOptions options;
  options.max_bytes = *directory_bytes(store_) / 2;
  const auto made = plan(options);
  ASSERT_OK(made);
  const auto report = carry_out(store_, *made, again(options, *made));
  ASSERT_OK(report);
  EXPECT_LE(report->bytes_after, *options.max_bytes);
  const auto found = read_nights(store_, 9);
  ASSERT_OK(found);
  ASSERT_EQ(found->nights.size(), 1u);
  const NightRecord& night = found->nights[0];
  EXPECT_EQ(night.work, NightWork::kForget);
  EXPECT_EQ(night.failure, "");
  uint64_t forgotten = 0;
  for (const NightEntity& entity : night.entities) {
    forgotten += entity.forgotten;
    EXPECT_LT(entity.bytes_after, entity.bytes_before);
  }
  EXPECT_EQ(forgotten, report->rewritten.snapshots);
  EXPECT_EQ(night.entities.size(), 2u);
}

TEST_F(CarryOut, AQuotaLeavesAsMuchAsItAllows) {
  // Everything in one segment, as a night leaves it, and a part of the file that does not shrink.
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 200; ++i)
    snapshots.push_back(noisy(i % 2 == 0 ? "cam" : "other", i, 8000));
  append(snapshots);
  for (const uint64_t percent : {80, 40, 15}) {
    SCOPED_TRACE(percent);
    ForgetOptions options;
    options.protection.newest = 0;
    options.max_bytes = context().store_bytes * percent / 100;
    const auto made = plan(options);
    ASSERT_TRUE(made.ok()) << made.status().to_string();
    const auto report = carry_out(store_, *made, again(options, *made));
    ASSERT_TRUE(report.ok()) << report.status().to_string();
    EXPECT_LE(context().store_bytes, *options.max_bytes);
    EXPECT_GE(context().store_bytes, *options.max_bytes * 4 / 5) << "what may stay, stays";
    EXPECT_LE(report->rounds, 5);
  }
}

TEST_F(CarryOut, ForgetsExactlyThePlan) {
  std::mt19937 random(7);
  for (int round = 0; round < 25; ++round) {
    SCOPED_TRACE(round);
    std::filesystem::remove_all(store_);
    ASSERT_OK(create_store(store_));
    content_.clear();
    fill(random);
    const ForgetOptions options = random_options(random, context().store_bytes);
    const auto made = plan(options);
    ASSERT_OK(made);
    expect_content_without({});
    const auto report = carry_out(store_, *made, {});
    ASSERT_OK(report);
    EXPECT_EQ(report->rewritten.snapshots, made->snapshots());
    expect_content_without(made->to_set());
    ForgetOptions rules = options;
    rules.max_bytes.reset();
    rules.first.clear();
    EXPECT_EQ(plan(rules)->snapshots(), 0u) << "rules leave nothing for a second time";
  }
}

TEST_F(CarryOut, MeetsTheQuotaInBytesOfTheDirectory) {
  seal_noise(12, 20'000);
  const uint64_t before = *directory_bytes(store_);
  for (const uint64_t percent : {90, 70, 45, 20}) {
    ForgetOptions options;
    options.max_bytes = before * percent / 100;
    const auto made = plan(options);
    ASSERT_OK(made);
    const auto report = carry_out(store_, *made, again(options, *made));
    ASSERT_OK(report);
    EXPECT_EQ(report->missing_bytes, 0u);
    EXPECT_LE(*directory_bytes(store_), *options.max_bytes);
    EXPECT_EQ(report->bytes_after, *directory_bytes(store_));
    // Nor does more go than about one segment.
    EXPECT_GT(*directory_bytes(store_),
              *options.max_bytes - std::min(before / 6, *options.max_bytes));
  }
}

TEST_F(CarryOut, MeetsTheQuotaWhereSegmentsGoInPart) {
  seal_noise(8, 20'000);
  seal_numbers("numbers", 0, 500);
  ForgetOptions options;
  ForgetRule& first = options.first.emplace_back();
  first.match = *EntityPattern::parse("Vision/RGB/head/other");
  first.age = AgePolicy::Options{};
  options.max_bytes = *directory_bytes(store_) - 100'000;
  const auto made = plan(options);
  const auto report = carry_out(store_, *made, again(options, *made));
  ASSERT_OK(report);
  EXPECT_LE(*directory_bytes(store_), *options.max_bytes);
  EXPECT_GE(report->rounds, 1u);
}

TEST_F(CarryOut, GoesOnWhereTheEstimateWasTooGood) {
  // The old ones are small and the new ones large, and count as equal.
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 24; ++i) snapshots.push_back(noisy("cam", i, i < 12 ? 10 : 20'000));
  append(snapshots);
  ForgetOptions options;
  options.max_bytes = *directory_bytes(store_) - 80'000;
  const auto made = plan(options);
  ASSERT_OK(made);
  EXPECT_EQ(made->missing_bytes, 0u);
  const auto report = carry_out(store_, *made, again(options, *made));
  ASSERT_OK(report);
  EXPECT_GE(report->rounds, 2u);
  EXPECT_GT(report->rewritten.snapshots, made->snapshots());
  EXPECT_LE(*directory_bytes(store_), *options.max_bytes);
}

TEST_F(CarryOut, TheEstimateIsExactWhereWholeSegmentsGo) {
  seal_noise(5, 20'000);
  ForgetOptions options;
  options.rules = {older_than(now_ - second(9))};
  const auto made = plan(options);
  const auto report = carry_out(store_, *made, {});
  ASSERT_OK(report);
  EXPECT_EQ(report->rewritten.snapshots, 9u);
  EXPECT_EQ(report->rewritten.freed_bytes(), made->freed_bytes);
}

TEST_F(CarryOut, AnEmptyPlanChangesNothing) {
  seal_numbers("cam", 0, 3);
  const uint64_t generation = read_manifest(store_)->generation;
  const auto report = carry_out(store_, *plan({}), {});
  ASSERT_OK(report);
  EXPECT_EQ(report->rounds, 0u);
  EXPECT_EQ(read_manifest(store_)->generation, generation);
}

TEST_F(CarryOut, AQuotaThatCannotBeMetEnds) {
  seal_noise(3, 1000);
  ForgetOptions options;
  options.max_bytes = 1;
  const auto made = plan(options);
  const auto report = carry_out(store_, *made, again(options, *made));
  ASSERT_OK(report);
  EXPECT_GT(report->missing_bytes, 0u);
  EXPECT_EQ((*StoreReader::open(store_))->entities().size(), 2u) << "the newest of each stays";
}

TEST_F(CarryOut, StopsBetweenSegmentsAndCanGoOn) {
  seal_noise(4, 1000);
  ForgetOptions options;
  options.rules = {older_than(Seconds(0))};
  const auto made = plan(options);
  std::stop_source stop;
  const auto report = carry_out(
      store_, *made, {}, [&stop](const Progress&) { stop.request_stop(); }, stop.get_token());
  ASSERT_OK(report);
  EXPECT_TRUE(report->rewritten.is_cancelled);
  EXPECT_GT(report->rewritten.snapshots, 0u);
  EXPECT_LT(report->rewritten.snapshots, made->snapshots());
  ASSERT_OK(carry_out(store_, *plan(options), {}));
  expect_content_without(made->to_set());
}

TEST_F(CarryOut, KilledAtAnyMomentNothingElseIsLost) {
  seal_noise(10, 3000);
  std::mt19937 random(3);
  ForgetSet to_go;
  int killed = 0;
  for (int round = 0; round < 10; ++round) {
    ForgetOptions options;
    options.rules = {older_than(now_ - second(2 * round + 2))};
    const auto made = plan(options);
    ASSERT_OK(made);
    for (const auto& [entity, times] : made->to_set()) to_go[entity].insert_all(times);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) ::_exit(carry_out(store_, *made, {}).ok() ? 0 : 1);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 8000));
    ::kill(child, SIGKILL);
    int outcome = 0;
    ::waitpid(child, &outcome, 0);
    killed += WIFSIGNALED(outcome) ? 1 : 0;
    EXPECT_TRUE(WIFSIGNALED(outcome) || WEXITSTATUS(outcome) == 0);
    // What was to go may be there still, whole; everything else is.
    const auto reader = *StoreReader::open(store_);
    for (const auto& [entity, snapshots] : content_) {
      const auto found = read_all(*reader, entity);
      ASSERT_OK(found);
      std::map<Time, Snapshot> by_time;
      for (const Snapshot& snapshot : *found) by_time[snapshot.time] = snapshot;
      for (const auto& [time, snapshot] : snapshots) {
        if (!by_time.contains(time))
          EXPECT_TRUE(to_go[entity].contains(time)) << entity.at(time).to_string();
        else
          EXPECT_EQ(by_time[time], snapshot);
      }
    }
  }
  EXPECT_GT(killed, 0) << "no run was killed in time";
  ASSERT_OK(StoreWriter::open(store_, {}));
  ptrdiff_t files = 0;
  for (const char* folder : {"segments", "tmp"})
    files += std::distance(std::filesystem::directory_iterator(store_ / folder), {});
  EXPECT_EQ(files, static_cast<ptrdiff_t>(read_manifest(store_)->segments.size()));
}

}  // namespace
}  // namespace engram::ltm
