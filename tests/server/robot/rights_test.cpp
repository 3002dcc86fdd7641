// SPDX-License-Identifier: Apache-2.0
// What the holders of tokens see and do: every token with every operation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "ltm/recall/recall.h"
#include "tests/ltm/expect_status.h"
#include "tests/server/access/secret_file.h"
#include "tests/server/robot/running_server.h"

namespace engram::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::RunningServer;

constexpr const char* kHallLamp = "Hall/a/b/lamp";
constexpr const char* kBedLamp = "Bedroom/a/b/lamp";
constexpr int64_t kCount = 40;

/// Snapshot `i` of each entity, ten a second.
Time time_of(int64_t i) {
  return time_from_ns((1'000 + i / 10) * 1'000'000'000 + i % 10 * 100'000'000);
}

/// What a token is expected to see of an entity: snapshots `first` to `last`.
struct Seen {
  int64_t first = 0;
  int64_t last = -1;
  bool predictions = false;
  /// Of commits; -1: may not write.
  int64_t writes_from = -1;

  [[nodiscard]] int64_t count() const { return last - first + 1; }
};

struct Holder {
  std::string rights;
  Seen hall, bed;
};

std::string seconds(int64_t s) {
  return "'" + engram::to_string(time_from_ns(s * 1'000'000'000)) + "'";
}

const std::map<std::string, Holder>& holders() {
  static const std::map<std::string, Holder> all{
      {"owner", {"role: admin, memories: all", {0, kCount - 1, true, 0}, {0, kCount - 1, true, 0}}},
      {"reader", {"role: read, memories: [Hall]", {0, kCount - 1, true}, {}}},
      {"entity", {"role: read, memories: [Hall/a/b/lamp]", {0, kCount - 1, true}, {}}},
      {"other", {"role: write, memories: [Hall/a/b/lam, Hall/a/x, Halls]", {}, {}}},
      {"recorder", {"grants: [{ids: [Hall], may: [write]}]", {0, -1, false, 0}, {}}},
      {"historian",
       {"grants: [{ids: all, may: [read], until: " + seconds(1001) + "}]", {0, 10}, {0, 10}}},
      {"window",
       {"grants: [{ids: [Hall], may: [read, write], from: " + seconds(1001) + ", until: " +
            seconds(1002) + "}, {ids: [Bedroom], may: [read], from: " + seconds(1003) + "}]",
        {10, 20, false, 10},
        {30, kCount - 1}}},
      {"never", {"grants: [{ids: all, may: [read], until: " + seconds(500) + "}]", {}, {}}},
      {"plain", {"grants: [{ids: [Hall], may: [read]}]", {0, kCount - 1}, {}}},
      {"models", {"grants: [{ids: [Bedroom], may: [read, models]}]", {}, {0, kCount - 1, true}}},
  };
  return all;
}

/// A server with two entities, whose older half is in the store alone if it has one.
class Rights : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    std::string tokens = "tokens:\n";
    for (const auto& [name, holder] : holders())
      tokens += fmt::format("  - {{name: {}, token_sha256: {}, {}}}\n", name,
                            to_hex(hash_token(name)), holder.rights);
    running_.options.tokens = testing::write_secret(running_.folder.path() / "tokens.yaml", tokens);
    if (GetParam()) {
      running_.with_store();
      running_.options.service.memory.all.snapshots = kCount;  // Of two entities.
    }
    running_.start();
    const auto owner = client("owner");
    for (int64_t i = 0; i < kCount; ++i)
      for (const char* entity : {kHallLamp, kBedLamp})
        ASSERT_OK(owner->commit(
            RunningServer::commit(entity, to_ns(time_of(i)), idf::Dict{{"x", 0.5 * i}})));
  }

  [[nodiscard]] std::unique_ptr<MemoryClient> client(const std::string& token) const {
    return running_.client({.token = token});
  }

  /// The snapshots of each entity that an answer has; predicted ones under their own name.
  static std::map<std::string, std::vector<Time>> times(const ltm::QueryResult& result) {
    std::map<std::string, std::vector<Time>> all;
    for (const ltm::EntityResult* entity : result.entities()) {
      auto& past = all[entity->id.to_string()];
      for (const ltm::SnapshotResult& snapshot : entity->snapshots)
        if (snapshot.source == ltm::Source::kPredicted)
          all[entity->id.to_string() + " predicted"].push_back(snapshot.time);
        else
          past.push_back(snapshot.time);
    }
    return all;
  }

  static std::vector<Time> times_of(int64_t first, int64_t last) {
    std::vector<Time> times;
    for (int64_t i = first; i <= last; ++i) times.push_back(time_of(i));
    return times;
  }

  /// Asks, and expects of each entity the snapshots that `expected` says.
  static void expect_answer(MemoryClient& client, const std::string& query,
                            const std::map<std::string, std::vector<Time>>& expected) {
    const auto answer = client.query(*ltm::Query::parse(query));
    if (expected.empty()) {
      EXPECT_EQ(answer.status().code(), StatusCode::kNotFound) << query;
      for (const char* hidden : {kHallLamp, kBedLamp})
        if (query.find(hidden) == std::string::npos) {
          EXPECT_THAT(answer.status().message(), Not(HasSubstr(hidden)));
        }
      return;
    }
    ASSERT_TRUE(answer.ok()) << query << ": " << answer.status().to_string();
    EXPECT_EQ(times(*answer), expected) << query;
  }

  RunningServer running_;
};

/// The part of `expected` that is not empty.
std::map<std::string, std::vector<Time>> both(std::vector<Time> hall, std::vector<Time> bed) {
  std::map<std::string, std::vector<Time>> expected;
  if (!hall.empty()) expected[kHallLamp] = std::move(hall);
  if (!bed.empty()) expected[kBedLamp] = std::move(bed);
  return expected;
}

TEST_P(Rights, PatternsFindWhatMayBeSeenAndNothingElse) {
  for (const auto& [name, holder] : holders()) {
    SCOPED_TRACE(name);
    const auto asking = client(name);
    const auto& [rights, hall, bed] = holder;
    for (const char* names : {".*", ".*/a/b/lamp", "?ids .*"}) {
      const std::string all(names);
      expect_answer(*asking, all + " @ all",
                    both(times_of(hall.first, hall.last), times_of(bed.first, bed.last)));
      expect_answer(*asking, all + " @ latest",
                    both(times_of(std::max(hall.first, hall.last), hall.last),
                         times_of(std::max(bed.first, bed.last), bed.last)));
      expect_answer(*asking, all + " @ latest:3",
                    both(times_of(std::max(hall.first, hall.last - 2), hall.last),
                         times_of(std::max(bed.first, bed.last - 2), bed.last)));
      expect_answer(*asking, all + " @ index:0..1",
                    both(times_of(hall.first, std::min(hall.first + 1, hall.last)),
                         times_of(bed.first, std::min(bed.first + 1, bed.last))));
    }
  }
}

TEST_P(Rights, NamesThatMayNotBeReadAreRefusedWhetherTheyExistOrNot) {
  for (const auto& [name, holder] : holders()) {
    SCOPED_TRACE(name);
    const auto asking = client(name);
    const auto is_refused = [&](const std::string& query) {
      const auto answer = asking->query(*ltm::Query::parse(query));
      return answer.status().code() == StatusCode::kFailedPrecondition;
    };
    for (const auto& [room, seen] : std::vector<std::pair<std::string, Seen>>{
             {"Hall", holder.hall}, {"Bedroom", holder.bed}}) {
      if (name == "entity" || name == "never") continue;  // See below.
      EXPECT_EQ(is_refused(room + "/a/b/lamp @ all"), seen.count() == 0);
      EXPECT_EQ(is_refused(room + "/a/b/none @ all"), seen.count() == 0);
    }
  }
  // Whose times have nothing sees the name as one that is not there.
  const auto never = client("never");
  expect_answer(*never, std::string(kHallLamp) + " @ all", {});
  const auto answer = never->query(*ltm::Query::parse("Hall/a/b/none"));
  EXPECT_EQ(answer.status().code(), StatusCode::kNotFound);
}

TEST_P(Rights, PredictionsNeedTheRightToThem) {
  const std::vector<Duration> ahead{std::chrono::milliseconds(200)};
  for (const auto& [name, holder] : holders()) {
    SCOPED_TRACE(name);
    const auto asking = client(name);
    for (const auto& [text, seen] : std::vector<std::pair<const char*, Seen>>{
             {kHallLamp, holder.hall}, {kBedLamp, holder.bed}}) {
      const ltm::MemoryId entity = *ltm::MemoryId::parse(text);
      const auto predicted = asking->predict(entity, ahead, {});
      EXPECT_EQ(predicted.ok(), seen.predictions) << predicted.status().to_string();
      EXPECT_EQ(asking->predict(entity, ahead, {.at = time_of(12)}).ok(), seen.predictions);
      EXPECT_EQ(asking->engines(entity, ahead).ok(), seen.predictions);
    }
    std::map<std::string, std::vector<Time>> expected;
    for (const auto& [text, seen] : std::vector<std::pair<std::string, Seen>>{
             {kHallLamp, holder.hall}, {kBedLamp, holder.bed}}) {
      if (seen.count() == 0) continue;
      expected[text] = times_of(seen.last, seen.last);
      if (seen.predictions)
        expected[text + " predicted"] = {time_of(kCount - 1) + std::chrono::milliseconds(200)};
    }
    expect_answer(*asking, ".* @ latest, +200ms", expected);
  }
  // A plan tells of itself.
  const ltm::MemoryId bed = *ltm::MemoryId::parse(kBedLamp);
  const auto refused =
      client("reader")->predict(*ltm::MemoryId::parse(kHallLamp), ahead, {.plan = bed});
  EXPECT_FAILS(refused, StatusCode::kFailedPrecondition, "may not read 'Bedroom/a/b/lamp'");
}

TEST_P(Rights, CommitsAndTypesNeedTheRightToWrite) {
  for (const auto& [name, holder] : holders()) {
    SCOPED_TRACE(name);
    const auto writing = client(name);
    for (const auto& [room, seen] : std::vector<std::pair<std::string, Seen>>{
             {"Hall", holder.hall}, {"Bedroom", holder.bed}}) {
      const std::string entity = fmt::format("{}/a/b/{}", room, name);
      for (const int64_t i : {0, 12, 39}) {
        const bool may = seen.writes_from == 0 || (seen.writes_from == 10 && i == 12);
        const Status status =
            writing->commit(RunningServer::commit(entity, to_ns(time_of(i)), int64_t{1}));
        EXPECT_EQ(status.ok(), may) << status.to_string();
        if (!may) {
          EXPECT_THAT(status.message(), HasSubstr(fmt::format("'{}' may not write", name)));
        }
      }
      const auto segment = *ltm::MemoryId::parse(room + "/typed");
      EXPECT_EQ(writing->declare(segment, idf::Type::int64()).ok(), seen.writes_from >= 0);
    }
  }
  // Of a commit of several entities all may be written, or none is.
  ltm::Commit mixed = RunningServer::commit("Hall/a/b/mixed", 1);
  mixed.updates.push_back(RunningServer::commit("Bedroom/a/b/mixed", 1).updates[0]);
  EXPECT_FAILS(client("recorder")->commit(mixed), StatusCode::kFailedPrecondition, "Bedroom");
  EXPECT_FALSE(client("owner")->query(*ltm::Query::parse("Hall/a/b/mixed")).ok());
}

/// Collects what a subscriber is told.
struct Heard {
  std::mutex mutex;
  std::condition_variable changed;
  std::multiset<std::pair<std::string, Time>> snapshots;
  bool has_ended = false;

  SubscriptionHandlers handlers() {
    SubscriptionHandlers made;
    made.on_snapshots = [this](std::vector<ToldSnapshot> told) {
      const std::scoped_lock lock(mutex);
      for (const ToldSnapshot& one : told)
        snapshots.emplace(one.snapshot.entity.to_string(), one.snapshot.time);
      changed.notify_all();
    };
    return made;
  }

  /// Waits for `count` snapshots, and a moment longer for those that should not come.
  void wait_for(size_t count) {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, std::chrono::seconds(20), [&] { return snapshots.size() >= count; });
    changed.wait_for(lock, std::chrono::milliseconds(50), [&] { return snapshots.size() > count; });
  }
};

TEST_P(Rights, SubscribersHearWhatTheyMaySee) {
  for (const bool with_data : {false, true}) {
    std::map<std::string, std::unique_ptr<MemoryClient>> clients;
    std::map<std::string, Heard> heard;
    std::vector<std::unique_ptr<Subscription>> subscriptions;
    for (const auto& [name, holder] : holders()) {
      clients[name] = client(name);
      auto subscription =
          clients[name]->subscribe({.names = {}, .with_data = with_data}, heard[name].handlers());
      ASSERT_OK(subscription);
      subscriptions.push_back(*std::move(subscription));
    }
    const auto owner = client("owner");
    const std::string thing = with_data ? "data" : "ids";
    // Large enough for shared memory, of which a block is read whole or not at all.
    const auto pixels = idf::NdArray::take({40'000}, std::vector<uint8_t>(40'000, 7));
    for (int64_t i = 0; i < kCount; ++i)
      for (const char* room : {"Hall", "Bedroom"})
        ASSERT_OK(owner->commit(RunningServer::commit(fmt::format("{}/a/b/{}", room, thing),
                                                      to_ns(time_of(i)), pixels)));
    for (const auto& [name, holder] : holders()) {
      SCOPED_TRACE(name);
      std::multiset<std::pair<std::string, Time>> expected;
      if (name != "entity")
        for (const auto& [room, seen] : std::vector<std::pair<std::string, Seen>>{
                 {"Hall", holder.hall}, {"Bedroom", holder.bed}})
          for (const Time time : times_of(seen.first, seen.last))
            expected.emplace(fmt::format("{}/a/b/{}", room, thing), time);
      heard[name].wait_for(expected.size());
      const std::scoped_lock lock(heard[name].mutex);
      EXPECT_EQ(heard[name].snapshots, expected);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutAStore, Rights, ::testing::Bool(),
                         [](const auto& one) { return one.param ? "Store" : "Memory"; });

TEST(Rights, OfSomeEntitiesTellNoFailuresOfOthers) {
  RunningServer running;
  running.options.tokens = testing::write_secret(
      running.folder.path() / "tokens.yaml",
      fmt::format("tokens:\n"
                  "  - {{name: owner, token_sha256: {}, role: admin, memories: all}}\n"
                  "  - {{name: guest, token_sha256: {}, role: read, memories: [Hall]}}\n",
                  to_hex(hash_token("owner")), to_hex(hash_token("guest"))));
  running.with_store();
  running.options.service.store->recording.store.min_free_bytes = uint64_t{1} << 62;
  running.start();
  const auto owner = running.client({.token = "owner"});
  EXPECT_FALSE(owner->commit(RunningServer::commit(kBedLamp, 1), CommitDurability::kJournal).ok());
  const auto all = owner->info();
  const auto some = running.client({.token = "guest"})->info();
  ASSERT_OK(all);
  ASSERT_OK(some);
  EXPECT_THAT(all->figures_json, HasSubstr("last_store_failure"));
  EXPECT_THAT(some->figures_json, Not(HasSubstr("last_store_failure")));
}

TEST(Rights, EndWithTheirTokenForThoseWhoAreConnected) {
  RunningServer running;
  const Time expires = system_now() + std::chrono::seconds(3);
  running.options.tokens = testing::write_secret(
      running.folder.path() / "tokens.yaml",
      fmt::format(
          "tokens:\n"
          "  - {{name: owner, token_sha256: {}, role: admin, memories: all}}\n"
          "  - {{name: guest, token_sha256: {}, role: read, memories: all, expires: '{}'}}\n",
          to_hex(hash_token("owner")), to_hex(hash_token("guest")), engram::to_string(expires)));
  running.start();
  const auto owner = running.client({.token = "owner"});
  const auto guest = running.client({.token = "guest"});
  Heard heard, heard_by_owner;
  const auto subscription = guest->subscribe({}, heard.handlers());
  const auto other = owner->subscribe({}, heard_by_owner.handlers());
  ASSERT_OK(subscription);
  ASSERT_OK(other);
  ASSERT_OK(owner->commit(RunningServer::commit(kHallLamp, 1)));
  heard.wait_for(1);
  ASSERT_OK(guest->query(*ltm::Query::parse(kHallLamp)));
  std::this_thread::sleep_until(expires + std::chrono::milliseconds(100));
  // The subscription was told of this entity before, and is told no more.
  ASSERT_OK(owner->commit(RunningServer::commit(kHallLamp, 2)));
  heard_by_owner.wait_for(2);
  {
    std::unique_lock lock(heard.mutex);
    EXPECT_FALSE(heard.changed.wait_for(lock, std::chrono::milliseconds(300),
                                        [&] { return heard.snapshots.size() > 1; }));
  }
  EXPECT_FALSE(guest->query(*ltm::Query::parse(kHallLamp)).ok());
  EXPECT_FALSE(guest->query(*ltm::Query::parse(".*")).ok());
}

/// A subscriber that reads nothing until its token has expired.
class SlowSubscriber {
 public:
  static constexpr size_t kMany = 50;

  explicit SlowSubscriber(Duration until_expiry) : expires_(system_now() + until_expiry) {
    running_.options.tokens = testing::write_secret(
        running_.folder.path() / "tokens.yaml",
        fmt::format(
            "tokens:\n"
            "  - {{name: owner, token_sha256: {}, role: admin, memories: all}}\n"
            "  - {{name: guest, token_sha256: {}, role: read, memories: all, expires: '{}'}}\n",
            to_hex(hash_token("owner")), to_hex(hash_token("guest")), engram::to_string(expires_)));
    running_.start();
  }

  /// Commits more than is under way at once. Returns false if the token has expired by then.
  bool is_told_of_many() {
    guest_ = running_.client({.token = "guest", .shares_memory = false});
    SubscriptionHandlers handlers;
    handlers.on_snapshots = [this](const std::vector<ToldSnapshot>& snapshots) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return reads_; });
      told_ += snapshots.size();
      changed_.notify_all();
    };
    subscription_ = guest_->subscribe({.names = {}, .with_data = true}, handlers);
    if (!subscription_.ok()) return false;
    const auto owner = running_.client({.token = "owner"});
    for (size_t i = 1; i <= kMany; ++i)
      EXPECT_OK(owner->commit(RunningServer::commit(
          kHallLamp, static_cast<int64_t>(i),
          idf::NdArray::take({1 << 20}, std::vector<uint8_t>(1 << 20, static_cast<uint8_t>(i))))));
    return system_now() < expires_;
  }

  /// How much it is told after its token has expired. Waits for more than it should be told.
  size_t read_after_expiry() {
    std::this_thread::sleep_until(expires_ + std::chrono::milliseconds(100));
    std::unique_lock lock(mutex_);
    reads_ = true;
    changed_.notify_all();
    changed_.wait_for(lock, std::chrono::seconds(3), [this] { return told_ == kMany; });
    return told_;
  }

  ~SlowSubscriber() {
    const std::unique_lock lock(mutex_);
    reads_ = true;
    changed_.notify_all();
  }

 private:
  const Time expires_;
  RunningServer running_;
  std::mutex mutex_;
  std::condition_variable changed_;
  size_t told_ = 0;
  bool reads_ = false;
  std::unique_ptr<MemoryClient> guest_;
  Result<std::unique_ptr<Subscription>> subscription_ = unavailable("none");
};

TEST(Rights, EndForWhatWaitsForASlowSubscriber) {
  // A busy machine takes longer to commit.
  for (const int seconds : {2, 8, 32}) {
    SlowSubscriber slow{std::chrono::seconds(seconds)};
    if (!slow.is_told_of_many()) continue;
    // What was on its way comes, and nothing of what still waited.
    EXPECT_LT(slow.read_after_expiry(), SlowSubscriber::kMany / 2);
    return;
  }
  FAIL() << "the machine is too slow for this test";
}

}  // namespace
}  // namespace engram::server
