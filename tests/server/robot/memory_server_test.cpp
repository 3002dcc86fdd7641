// SPDX-License-Identifier: Apache-2.0
#include "server/robot/memory_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "ltm/recall/recall.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/server/robot/running_server.h"

namespace engram::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::RunningServer;
using ::testing::SizeIs;

constexpr const char* kCam = "Vision/RGB/head/cam";

std::vector<int64_t> times(const ltm::QueryResult& result) {
  std::vector<int64_t> all;
  for (const ltm::EntityResult* entity : result.entities())
    for (const ltm::SnapshotResult& snapshot : entity->snapshots)
      all.push_back(to_ns(snapshot.time));
  return all;
}

Result<std::vector<int64_t>> ask(MemoryClient& client, const std::string& query) {
  ENGRAM_ASSIGN_OR_RETURN(const auto result, client.query(*ltm::Query::parse(query)));
  return times(result);
}

/// Collects what a subscriber is told.
struct Told {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<ToldSnapshot> snapshots;
  uint64_t lost = 0;

  SubscriptionHandlers handlers() {
    SubscriptionHandlers made;
    made.on_snapshots = [this](std::vector<ToldSnapshot> told) {
      const std::scoped_lock lock(mutex);
      for (ToldSnapshot& one : told) snapshots.push_back(std::move(one));
      changed.notify_all();
    };
    made.on_lost = [this](uint64_t count) {
      const std::scoped_lock lock(mutex);
      lost += count;
      changed.notify_all();
    };
    return made;
  }

  bool wait_for(size_t count) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(10),
                            [&] { return snapshots.size() + lost >= count; });
  }
};

TEST(MemoryServer, AnswersWithWhatWasCommitted) {
  RunningServer running;
  running.start();
  const auto client = running.client();
  const idf::Data image = idf::NdArray::take({2, 2}, std::vector<uint8_t>{1, 2, 3, 4});
  ASSERT_TRUE(client->commit(RunningServer::commit(kCam, 100, image)).ok());
  const auto result = client->query(*ltm::Query::parse(std::string(kCam) + " @ latest"));
  ASSERT_TRUE(result.ok()) << result.status().to_string();
  ASSERT_THAT(times(*result), ElementsAre(100));
  const auto& snapshot = result->entities()[0]->snapshots[0];
  EXPECT_EQ(snapshot.instances[0].data, image);
  EXPECT_EQ(snapshot.source, ltm::Source::kRecorded);
  EXPECT_GT(to_ns(snapshot.instances[0].metadata.arrived), 0);
}

TEST(MemoryServer, TellsSubscribersOfWhatTheyAskedFor) {
  RunningServer running;
  running.start();
  const auto client = running.client();
  Told told;
  const auto subscription =
      client->subscribe({.names = {"Vision/.*/.*/cam"}, .with_data = true}, told.handlers());
  ASSERT_TRUE(subscription.ok()) << subscription.status().to_string();
  ASSERT_TRUE(client->commit(RunningServer::commit("Robot/a/b/c", 1)).ok());
  ASSERT_TRUE(client->commit(RunningServer::commit(kCam, 2, int64_t{5})).ok());
  ASSERT_TRUE(told.wait_for(1));
  const std::scoped_lock lock(told.mutex);
  ASSERT_THAT(told.snapshots, SizeIs(1));
  EXPECT_TRUE(told.snapshots[0].has_data);
  EXPECT_EQ(told.snapshots[0].snapshot.id().to_string(),
            ltm::MemoryId::parse(kCam)->at(time_from_ns(2)).to_string());
  EXPECT_EQ(told.snapshots[0].snapshot.instances[0].data, idf::Data(int64_t{5}));
}

TEST(MemoryServer, TellsIdsAloneUnlessDataAreAskedFor) {
  RunningServer running;
  running.start();
  const auto client = running.client();
  Told told;
  const auto subscription = client->subscribe({}, told.handlers());
  ASSERT_TRUE(subscription.ok());
  ASSERT_TRUE(client->commit(RunningServer::commit(kCam, 2)).ok());
  ASSERT_TRUE(told.wait_for(1));
  const std::scoped_lock lock(told.mutex);
  EXPECT_FALSE(told.snapshots[0].has_data);
  EXPECT_THAT(told.snapshots[0].snapshot.instances, SizeIs(1));
}

TEST(MemoryServer, TellsLargePayloadsThroughSharedMemory) {
  RunningServer running;
  running.start();
  const auto producer = running.client();
  const auto consumer = running.client();
  Told told;
  const auto subscription = consumer->subscribe({.names = {}, .with_data = true}, told.handlers());
  ASSERT_TRUE(subscription.ok());
  std::vector<uint8_t> pixels(1 << 20);
  for (int i = 1; i <= 20; ++i) {
    std::ranges::fill(pixels, static_cast<uint8_t>(i));
    ltm::Commit commit = RunningServer::commit(kCam, i, idf::NdArray::take({1 << 20}, pixels));
    commit.updates.push_back(RunningServer::commit("Vision/RGB/head/other", i).updates[0]);
    const Status status = producer->commit(commit);
    ASSERT_TRUE(status.ok()) << status.to_string();
  }
  ASSERT_TRUE(told.wait_for(40));
  {
    const std::scoped_lock lock(told.mutex);
    ASSERT_THAT(told.snapshots, SizeIs(40));
    for (size_t i = 0; i < 20; ++i) {
      const auto* array = told.snapshots[2 * i].snapshot.instances[0].data.get_if<idf::NdArray>();
      ASSERT_NE(array, nullptr);
      ASSERT_EQ(array->bytes().size(), size_t{1} << 20);
      EXPECT_EQ(array->bytes()[1000], static_cast<std::byte>(i + 1));
    }
    EXPECT_THAT(producer->info()->figures_json, HasSubstr("\"shared_reads\":20"));
    told.snapshots.clear();
  }
  // What is not read any more is the server's again, soon.
  for (int i = 0; i < 200; ++i) {
    if (producer->info()->figures_json.find("\"shared_reads\":0") != std::string::npos) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_THAT(producer->info()->figures_json, HasSubstr("\"shared_reads\":0"));
  // The answer to a query is the same.
  const auto answer = consumer->query(*ltm::Query::parse(std::string(kCam) + " @ latest"));
  ASSERT_TRUE(answer.ok());
  EXPECT_EQ(answer->entities()[0]->snapshots[0].instances[0].data,
            idf::Data(idf::NdArray::take({1 << 20}, pixels)));
}

TEST(MemoryServer, PutsNothingIntoSharedMemoryThatIsStillToBeRedacted) {
  RunningServer running;
  running.with_store();
  ltm::EntityRule rule{"cameras", *ltm::EntityPattern::parse("Vision"), {}, {}, {}, {}};
  rule.redact = ltm::testing::marker_redaction(running.folder.path());
  running.options.service.store->recording.rules = {rule};
  running.start();
  const auto producer = running.client();
  const auto consumer = running.client();
  Told told;
  const auto subscription =
      consumer->subscribe({.names = {"Vision"}, .with_data = true}, told.handlers());
  ASSERT_TRUE(subscription.ok());
  const idf::NdArray image = ltm::testing::image_with_secret(400, 300, 200, 100);
  for (int i = 1; i <= 5; ++i) {
    ASSERT_TRUE(producer->commit(RunningServer::commit(kCam, i, image)).ok());
    EXPECT_THAT(producer->info()->figures_json, HasSubstr("\"shared_bytes\":0"));
  }
  ASSERT_TRUE(told.wait_for(5));
  {
    const std::scoped_lock lock(told.mutex);
    ASSERT_THAT(told.snapshots, SizeIs(5));
    for (const ToldSnapshot& one : told.snapshots)
      EXPECT_FALSE(ltm::testing::has_secret(one.snapshot.instances[0].data.get<idf::NdArray>()));
  }
  const auto answer = consumer->query(*ltm::Query::parse(std::string(kCam) + " @ latest"));
  ASSERT_TRUE(answer.ok());
  const idf::Data& kept = answer->entities()[0]->snapshots[0].instances[0].data;
  EXPECT_EQ(kept.get<idf::NdArray>().shape(), image.shape());
  EXPECT_FALSE(ltm::testing::has_secret(kept.get<idf::NdArray>()));
  EXPECT_THAT(producer->info()->figures_json, HasSubstr("\"redact_redacted\":5"));
  // Other memories share as before.
  const auto plain = idf::NdArray::take({1 << 20}, std::vector<uint8_t>(1 << 20, 7));
  for (int i = 1; i <= 2; ++i)
    ASSERT_TRUE(producer->commit(RunningServer::commit("Robot/a/b/c", i, plain)).ok());
  EXPECT_THAT(producer->info()->figures_json, ::testing::Not(HasSubstr("\"shared_bytes\":0")));
}

TEST(MemoryServer, PredictsWhatComesByTheBestEngine) {
  RunningServer running;
  running.with_store();
  running.options.service.memory.all.snapshots = 40;  // The rest is in the store.
  running.start();
  const auto client = running.client();
  const auto at = [](int i) { return int64_t{1'000'000'000} * 100 + int64_t{100'000'000} * i; };
  for (int i = 0; i < 100; ++i) {
    const idf::Data value = idf::Dict{{"x", 0.5 * i}, {"name", "cup"}};
    ASSERT_TRUE(client->commit(RunningServer::commit("Robot/a/b/c", at(i), value)).ok());
  }
  const auto answer = client->query(*ltm::Query::parse("Robot/a/b/c @ +400ms"));
  ASSERT_TRUE(answer.ok()) << answer.status().to_string();
  const ltm::SnapshotResult& predicted = answer->entities()[0]->snapshots[0];
  EXPECT_EQ(predicted.source, ltm::Source::kPredicted);
  EXPECT_EQ(to_ns(predicted.time), at(103));
  EXPECT_NEAR(predicted.instances[0].data.at("x")->get<double>(), 0.5 * 103, 1e-6);
  EXPECT_EQ(predicted.instances[0].data.at("name")->get<std::string>(), "cup");
  EXPECT_NE(predicted.predictor, "copy-last");
  ASSERT_TRUE(predicted.instances[0].error);
  EXPECT_NEAR(predicted.instances[0].error->number_mse, 0, 1e-6);
  const auto copied = client->query(*ltm::Query::parse("Robot/a/b/c @ +400ms"), "copy-last");
  ASSERT_TRUE(copied.ok());
  EXPECT_NEAR(copied->entities()[0]->snapshots[0].instances[0].data.at("x")->get<double>(), 49.5,
              1e-9);
  EXPECT_EQ(client->query(*ltm::Query::parse("Robot/a/b/c @ +400ms"), "magic").status().code(),
            StatusCode::kNotFound);
  EXPECT_EQ(client->query(*ltm::Query::parse("Robot/a/b/c @ +400h")).status().code(),
            StatusCode::kInvalidArgument);
  const std::vector<Duration> horizons{std::chrono::milliseconds(400)};
  const auto engines = client->engines(*ltm::MemoryId::parse("Robot/a/b/c"), horizons);
  ASSERT_TRUE(engines.ok()) << engines.status().to_string();
  ASSERT_GT((*engines)[0].size(), 3u);
  EXPECT_EQ((*engines)[0][0].engine, predicted.predictor);
}

TEST(MemoryServer, CountsWhatASlowSubscriberLoses) {
  RunningServer running;
  running.start();
  const auto client = running.client({.shares_memory = false});
  Told told;
  SubscriptionHandlers handlers = told.handlers();
  std::mutex gate;
  std::unique_lock closed(gate);
  handlers.on_snapshots = [&, count = told.handlers().on_snapshots](std::vector<ToldSnapshot> all) {
    const std::scoped_lock wait(gate);
    count(std::move(all));
  };
  const auto subscription =
      client->subscribe({.names = {}, .with_data = true, .queue_bound = 4}, std::move(handlers));
  ASSERT_TRUE(subscription.ok());
  const idf::Data large = idf::NdArray::take({1 << 20}, std::vector<uint8_t>(1 << 20));
  constexpr int kCommits = 40;
  for (int i = 1; i <= kCommits; ++i)
    ASSERT_TRUE(client->commit(RunningServer::commit(kCam, i, large)).ok());
  closed.unlock();
  ASSERT_TRUE(told.wait_for(kCommits));
  const std::scoped_lock lock(told.mutex);
  EXPECT_GT(told.lost, 0u);
  EXPECT_EQ(told.snapshots.size() + told.lost, static_cast<size_t>(kCommits));
  EXPECT_EQ(to_ns(told.snapshots.back().snapshot.time), kCommits);
}

TEST(MemoryServer, RefusesWhatIsNoCommit) {
  RunningServer running;
  running.start();
  const auto client = running.client();
  const Status status = client->commit({{{*ltm::MemoryId::parse("Vision/RGB"), Time(), {}}}});
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("Vision/RGB"));
  EXPECT_TRUE(client->commit(RunningServer::commit(kCam, 1)).ok());
}

TEST(MemoryServer, RefusesMemoriesOfOthers) {
  RunningServer running;
  running.options.service.memories = {"Grasp"};
  running.start();
  const Status status = running.client()->commit(RunningServer::commit(kCam, 1));
  EXPECT_EQ(status.code(), StatusCode::kNotFound);
  EXPECT_THAT(status.message(), HasSubstr("Grasp"));
}

TEST(MemoryServer, AnswersFromMemoryAndStoreAsIfTheyWereOne) {
  RunningServer running;
  running.with_store();
  running.options.service.memory.all.snapshots = 3;
  running.start();
  const auto client = running.client();
  for (int i = 1; i <= 10; ++i) {
    ASSERT_TRUE(client->commit(RunningServer::commit(kCam, i * 10)).ok());
    // What is asked meanwhile is somewhere, always.
    ASSERT_THAT(*ask(*client, std::string(kCam) + " @ all"), SizeIs(static_cast<size_t>(i)));
  }
  EXPECT_THAT(*ask(*client, std::string(kCam) + " @ latest:5"), ElementsAre(60, 70, 80, 90, 100));
  EXPECT_THAT(*ask(*client, std::string(kCam) + " @ 0..1"), ElementsAre(10, 20));
  EXPECT_THAT(*ask(*client, std::string(kCam) + " @ -9..-8"), ElementsAre(20, 30));
  EXPECT_THAT(*ask(*client, std::string(kCam) + " @ nearest:52, at-or-before:29"),
              ElementsAre(20, 50));
  EXPECT_THAT(*ask(*client, ".* @ latest"), ElementsAre(100));
  EXPECT_EQ(ask(*client, "No/such/thing/here").status().code(), StatusCode::kNotFound);
}

TEST(MemoryServer, KeepsEverythingWhenItStops) {
  RunningServer running;
  running.with_store();
  running.start();
  for (int i = 1; i <= 5; ++i)
    ASSERT_TRUE(running.client()->commit(RunningServer::commit(kCam, i)).ok());
  ASSERT_TRUE(running.server->stop().ok());
  running.server.reset();
  running.start();
  EXPECT_THAT(*ask(*running.client(), std::string(kCam) + " @ all"), ElementsAre(1, 2, 3, 4, 5));
}

TEST(MemoryServer, AcknowledgesWhatIsInTheJournal) {
  RunningServer running;
  running.with_store();
  running.start();
  ASSERT_TRUE(
      running.client()->commit(RunningServer::commit(kCam, 7), CommitDurability::kJournal).ok());
  auto store = ltm::StoreReader::open(running.store());
  ASSERT_TRUE(store.ok());
  const auto timeline = (*store)->timeline(*ltm::MemoryId::parse(kCam));
  ASSERT_TRUE(timeline.ok());
  EXPECT_EQ((*timeline)->last(), time_from_ns(7));
}

TEST(MemoryServer, SaysThatThereIsNoStoreForWhatMustBeDurable) {
  RunningServer running;
  running.start();
  const Status status =
      running.client()->commit(RunningServer::commit(kCam, 7), CommitDurability::kJournal);
  EXPECT_EQ(status.code(), StatusCode::kFailedPrecondition);
}

TEST(MemoryServer, ClientsGoOnWhenItStartsOver) {
  RunningServer running;
  running.with_store();
  running.start();
  const auto client = running.client();
  Told told;
  const auto subscription = client->subscribe({}, told.handlers());
  ASSERT_TRUE(subscription.ok());
  ASSERT_TRUE(client->commit(RunningServer::commit(kCam, 1)).ok());
  ASSERT_TRUE(told.wait_for(1));
  running.server.reset();
  std::jthread later([&running] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    running.start();
  });
  ASSERT_TRUE(client->commit(RunningServer::commit(kCam, 2)).ok());
  later.join();
  EXPECT_THAT(*ask(*client, std::string(kCam) + " @ all"), ElementsAre(1, 2));
  // Subscribed again by itself; what came meanwhile may not have been told.
  for (int64_t at = 3; at < 100; ++at) {
    ASSERT_TRUE(client->commit(RunningServer::commit(kCam, at)).ok());
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::scoped_lock lock(told.mutex);
    if (told.snapshots.size() > 1) return;
  }
  FAIL() << "was not told of anything after the server had started over";
}

TEST(MemoryServer, RefusesToListenWhereAnotherServerDoes) {
  RunningServer running;
  running.start();
  const auto second = MemoryServer::start(running.options, nullptr);
  EXPECT_EQ(second.status().code(), StatusCode::kFailedPrecondition);
  EXPECT_TRUE(running.client()->commit(RunningServer::commit(kCam, 1)).ok());
}

TEST(MemoryServer, RefusesToListenToTheWorldWithoutProtection) {
  RunningServer running;
  running.options.rpc.endpoints.push_back(*Endpoint::parse("0.0.0.0:0"));
  const auto refused = MemoryServer::start(running.options, nullptr);
  EXPECT_EQ(refused.status().code(), StatusCode::kFailedPrecondition);
  EXPECT_THAT(refused.status().message(), HasSubstr("certificate"));
}

TEST(MemoryServer, ServesManyAtOnce) {
  RunningServer running;
  running.with_store();
  running.options.service.memory.all.snapshots = 50;
  running.start();
  constexpr int kThreads = 8;
  constexpr int kEach = 50;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t)
      threads.emplace_back([&running, t] {
        const auto client = running.client();
        const std::string entity = fmt::format("Vision/RGB/head/cam{}", t);
        for (int i = 1; i <= kEach; ++i) {
          const Status status = client->commit(RunningServer::commit(entity, i));
          ASSERT_TRUE(status.ok()) << status.to_string();
          if (i % 10 != 0) continue;
          ASSERT_THAT(*ask(*client, entity + " @ all"), SizeIs(static_cast<size_t>(i)));
        }
      });
  }
  EXPECT_THAT(*ask(*running.client(), "Vision @ all"), SizeIs(size_t{kThreads} * kEach));
}

TEST(MemoryServer, SaysWhatItCounts) {
  RunningServer running;
  running.start();
  const auto client = running.client();
  ASSERT_TRUE(client->commit(RunningServer::commit(kCam, 1)).ok());
  const auto info = client->info();
  ASSERT_TRUE(info.ok());
  EXPECT_EQ(info->server, "test");
  EXPECT_THAT(info->figures_json, HasSubstr("\"memory_committed\":1"));
  const auto metrics = client->metrics();
  ASSERT_TRUE(metrics.ok());
  EXPECT_THAT(*metrics, HasSubstr("\nengram_commits_total 1\n"));
}

}  // namespace
}  // namespace engram::server
