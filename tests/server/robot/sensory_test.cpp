// SPDX-License-Identifier: Apache-2.0
// Sensory memory between clients and a server.
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "server/client/shared_lane.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/server/access/secret_file.h"
#include "tests/server/robot/sensory_fixture.h"

namespace engram::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

INSTANTIATE_TEST_SUITE_P(SharesMemory, Sensory, ::testing::Bool());

TEST_P(Sensory, KeepsNothingOfWhatNobodyAttendsTo) {
  start(50ms);
  for (int64_t at = 1; at <= 30; ++at) ASSERT_OK(commit(kLeft, at));
  EXPECT_EQ(counts().committed, 30u);
  EXPECT_EQ(counters().memory.committed, 0u);
  const auto text = client_->metrics();
  ASSERT_OK(text);
  if (shares()) {
    EXPECT_THAT(*text, HasSubstr("engram_commits_total 1\n"));
  }
  EXPECT_THAT(*text, HasSubstr("engram_sensory_committed 30\n"));
  std::this_thread::sleep_for(200ms);
  EXPECT_EQ(counts().lost(), 30u);
  EXPECT_EQ(counts().held_bytes, 0u);
}

TEST_P(Sensory, ASubscriberIsToldOfWhatCameBefore) {
  start();
  for (int64_t at = 1; at <= 5; ++at) {
    ASSERT_OK(commit(kLeft, at));
    ASSERT_OK(commit(kRight, 100 + at));
  }
  ToldImages told;
  auto subscription =
      running_.client()->subscribe({.names = {kLeft}, .with_data = true}, told.handlers());
  ASSERT_OK(subscription);
  for (int64_t at = 6; at <= 9; ++at) {
    ASSERT_OK(commit(kLeft, at));
    ASSERT_OK(commit(kRight, 100 + at));
  }
  EXPECT_THAT(told.wait_for(9), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
  EXPECT_EQ(told.broken(), 0);
  subscription->reset();
  // The server hears of the end a little later.
  for (int64_t at = 10; at < 1000 && counts().held == 9; ++at) {
    ASSERT_OK(commit(kLeft, at));
    std::this_thread::sleep_for(5ms);
  }
  ASSERT_EQ(counts().held, 10u)
      << "nine of the right eye, and one to which nobody attends any more";
  const uint64_t passed = counts().passed;
  ASSERT_OK(commit(kLeft, 2000));
  EXPECT_EQ(counts().passed, passed);
  EXPECT_EQ(counts().held, 11u);
}

TEST_P(Sensory, ASubscriberIsToldOfAllThatWasHeldHoweverMuch) {
  start();
  constexpr int64_t kHeld = 3000;
  for (int64_t at = 1; at <= kHeld; ++at) ASSERT_OK(commit(kLeft, at, 100));
  ToldImages told;
  SubscriptionHandlers handlers = told.handlers();
  std::atomic<uint64_t> lost{0};
  handlers.on_lost = [&lost](uint64_t count) { lost += count; };
  const auto subscription =
      running_.client()->subscribe({.names = {kLeft}, .with_data = true}, std::move(handlers));
  ASSERT_OK(subscription);
  EXPECT_EQ(told.wait_for(kHeld).size(), static_cast<size_t>(kHeld));
  EXPECT_EQ(lost, 0u);
}

/// Many commits wait for their replies at once, in a ring that holds few of them: it asks the
/// server to take some before it writes over them.
class SensoryBurst : public Sensory {
 protected:
  void expect_all_pass(Duration hold) {
    running_.options.service.sensory.ring_bytes = size_t{256} << 10;
    start(hold);
    const auto attention = running_.server->service().attend(kLeft);
    ASSERT_OK(attention);
    constexpr int64_t kCommits = 2000;
    std::atomic<int64_t> done{0};
    std::atomic<int64_t> failed{0};
    ASSERT_OK(commit(kLeft, 1));
    for (int64_t at = 2; at <= kCommits; ++at)
      client_->commit(image_commit(kLeft, at), CommitDurability::kDefault,
                      [&](const Status& status) {
                        if (!status.ok()) ++failed;
                        ++done;
                      });
    const SteadyTime end = steady_now() + 30s;
    while (done < kCommits - 1 && steady_now() < end) std::this_thread::sleep_for(1ms);
    ASSERT_EQ(done, kCommits - 1);
    EXPECT_EQ(failed, 0);
    EXPECT_EQ(counters().memory.committed, static_cast<uint64_t>(kCommits));
    EXPECT_EQ(counts().passed, static_cast<uint64_t>(kCommits));
    EXPECT_EQ(counts().refused, 0u);
    EXPECT_EQ(counts().crowded_out, 0u) << "all of them passed";
  }
};

TEST_F(SensoryBurst, WhatIsAttendedToPassesHoweverFastItComes) {
  expect_all_pass(10s);
}

TEST_F(SensoryBurst, WhatIsAttendedToPassesHoweverLateTheServerIs) {
  expect_all_pass(1ms);
}

TEST_P(Sensory, AQueryFindsWhatIsHeldAndAttendsForAWhile) {
  start();
  for (int64_t at = 1; at <= 3; ++at) ASSERT_OK(commit(kLeft, at));
  EXPECT_THAT(ask("Vision @ all"), ElementsAre(1, 2, 3));
  std::this_thread::sleep_for(100ms);
  const uint64_t passed = counts().passed;
  ASSERT_OK(commit(kLeft, 4));
  EXPECT_EQ(counts().passed, passed);
  EXPECT_THAT(ask(std::string(kLeft) + " @ latest"), ElementsAre(4));
  EXPECT_EQ(counters().memory.superseded, 0u);
}

TEST_P(Sensory, KeepsWhatMustBeDurable) {
  running_.with_store();
  running_.options.durability = memory::MemoryService::Durability::kJournal;
  start();
  ASSERT_OK(commit(kLeft, 1));
  ASSERT_OK(commit(kLeft, 2));
  EXPECT_EQ(counters().memory.committed, 0u) << "it did not ask for it itself";
  ASSERT_OK(client_->commit(image_commit(kLeft, 3), CommitDurability::kJournal));
  EXPECT_EQ(counters().memory.committed, 1u);
  EXPECT_EQ(counters().store->recorded, 1u);
  EXPECT_THAT(ask("Vision @ all"), ElementsAre(1, 2, 3));
}

TEST_P(Sensory, OneCommitMayHaveBoth) {
  start();
  for (int64_t at = 1; at <= 3; ++at) {
    ltm::Commit both = image_commit(kLeft, at);
    both.updates.push_back(RunningServer::commit("Robot/a/b/c", at).updates.front());
    ASSERT_OK(client_->commit(both));
    ltm::Commit eyes = image_commit(kLeft, 10 + at);
    eyes.updates.push_back(image_commit(kRight, 10 + at).updates.front());
    ASSERT_OK(client_->commit(eyes));
  }
  EXPECT_EQ(counters().memory.committed, 3u);
  EXPECT_EQ(counts().held, 9u);
  EXPECT_THAT(ask(kRight + std::string(" @ all")), ElementsAre(11, 12, 13));
  EXPECT_THAT(ask(kLeft + std::string(" @ all")), ElementsAre(1, 2, 3, 11, 12, 13));
}

TEST_P(Sensory, SaysWhatIsTooLargeOrTooMuch) {
  running_.options.service.sensory.ring_bytes = size_t{256} << 10;
  start();
  ASSERT_OK(commit(kLeft, 1));
  EXPECT_FAILS(commit(kLeft, 2, size_t{300} << 10), StatusCode::kResourceExhausted, kLeft);
  ::testing::internal::CaptureStderr();
  for (int64_t at = 3; at <= 40; ++at) ASSERT_OK(commit(kLeft, at, 20'000));
  std::this_thread::sleep_for(100ms);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("sensory_crowded_out"));
  EXPECT_GT(counts().crowded_out, 20u);
  EXPECT_EQ(counts().committed, 39u);
}

TEST_P(Sensory, ForgetsWhatIsHeld) {
  start();
  for (int64_t at = 1; at <= 3; ++at) ASSERT_OK(commit(kLeft, at));
  ASSERT_OK(commit(kRight, 4));
  const auto forgotten = running_.client()->forget({.targets = {kLeft}});
  ASSERT_OK(forgotten);
  EXPECT_EQ(forgotten->snapshots, 3u);
  EXPECT_THAT(ask("Vision @ all"), ElementsAre(4));
}

class FirstOnes final : public ltm::View {
 public:
  [[nodiscard]] ltm::Sight of(const ltm::MemoryId& entity) const override {
    if (entity.to_string() != kLeft) return {};
    ltm::TimeWindows times;
    times.add({.first = time_from_ns(0), .last = time_from_ns(2)});
    return {times, times, false};
  }
};

TEST_P(Sensory, ForgettingTakesNothingThatMayNotBeErased) {
  start();
  for (int64_t at = 1; at <= 5; ++at) {
    ASSERT_OK(commit(kLeft, at));
    ASSERT_OK(commit(kRight, at));
  }
  memory::ForgetRequest request;
  request.targets = {"Vision"};
  request.view = std::make_shared<FirstOnes>();
  const auto forgotten = running_.server->service().forget(std::move(request));
  ASSERT_OK(forgotten);
  EXPECT_EQ(forgotten->snapshots, 2u);
  EXPECT_EQ(counts().passed, 2u);
  EXPECT_EQ(counts().held, 8u);
  ASSERT_OK(commit(kLeft, 6));
  EXPECT_EQ(counts().held, 9u) << "nobody attends";
  EXPECT_THAT(ask(std::string(kLeft) + " @ all"), ElementsAre(3, 4, 5, 6)) << "they pass later";
}

TEST_P(Sensory, WhoMayNotWriteIsToldSo) {
  std::string tokens = "tokens:\n";
  for (const auto& [name, rights] : std::vector<std::pair<std::string, std::string>>{
           {"left", "grants: [{ids: [Vision/RGB/head/left], may: [write]}]"},
           {"owner", "role: admin, memories: all"}})
    tokens += fmt::format("  - {{name: {}, token_sha256: {}, {}}}\n", name,
                          to_hex(hash_token(name)), rights);
  running_.options.tokens = testing::write_secret(running_.folder.path() / "tokens.yaml", tokens);
  start();
  client_ = running_.client({.token = "left", .shares_memory = shares()});
  for (int64_t at = 1; at <= 3; ++at) {
    ASSERT_OK(commit(kLeft, at));
    EXPECT_FAILS(commit(kRight, at), StatusCode::kFailedPrecondition, kRight);
  }
  // It may not read what it wrote, so its questions do not attend.
  EXPECT_FALSE(client_->query(*ltm::Query::parse("Vision @ latest")).ok());
  EXPECT_EQ(counts().passed, 0u);
  const auto owner = running_.client({.token = "owner"});
  const auto result = owner->query(*ltm::Query::parse("Vision @ all"));
  ASSERT_OK(result);
  EXPECT_EQ(counts().passed, 3u);
}

TEST_P(Sensory, WhatPassesCountsAgainstTheRateAndRefusalsAreNoted) {
  const std::filesystem::path log = running_.folder.path() / "audit.log";
  ASSERT_OK(AuditLog::create(log));
  std::string tokens = "tokens:\n";
  for (const auto& [name, rights] : std::vector<std::pair<std::string, std::string>>{
           {"eager", "role: write, memories: [Vision], rate: 20Hz"},
           {"owner", "role: admin, memories: all"}})
    tokens += fmt::format("  - {{name: {}, token_sha256: {}, {}}}\n", name,
                          to_hex(hash_token(name)), rights);
  running_.options.tokens = testing::write_secret(running_.folder.path() / "tokens.yaml", tokens);
  auto opened = AuditLog::open(log);
  ASSERT_OK(opened);
  running_.options.audit = *std::move(opened);
  start();
  client_ = running_.client({.token = "eager", .shares_memory = shares()});
  const auto attention = running_.server->service().attend(kLeft);
  ASSERT_OK(attention);
  int refused = 0;
  for (int64_t at = 1; at <= 100; ++at) {
    const Status status = commit(kLeft, at, 10);
    if (status.ok()) continue;
    EXPECT_FAILS(status, StatusCode::kResourceExhausted, "eager");
    ++refused;
  }
  EXPECT_GT(refused, 30);
  const auto text = running_.client({.token = "owner"})->metrics();
  ASSERT_OK(text);
  EXPECT_THAT(*text, HasSubstr(fmt::format("engram_commits_total 100\n")));
  EXPECT_THAT(*text, HasSubstr(fmt::format("engram_commits_refused_total {}\n", refused)));
  EXPECT_THAT(*text, HasSubstr(fmt::format("engram_requests_over_rate_total {}\n", refused)));
  EXPECT_EQ(counters().memory.committed, static_cast<uint64_t>(100 - refused));
  client_.reset();
  ASSERT_OK(running_.server->stop());
  running_.server.reset();
  running_.options.audit.reset();
  std::ifstream noted(log);
  int lines = 0;
  for (std::string line; std::getline(noted, line);)
    lines +=
        line.find("more requests") != std::string::npos && line.find("eager") != std::string::npos;
  EXPECT_GT(lines, 0) << "the log counts what comes again";
}

TEST_P(Sensory, WhatWasHeldPassesWhateverTheRate) {
  const std::string token = "  - {name: eager, token_sha256: " + to_hex(hash_token("eager")) +
                            ", role: admin, memories: all, rate: 20Hz}\n";
  running_.options.tokens =
      testing::write_secret(running_.folder.path() / "tokens.yaml", "tokens:\n" + token);
  start();
  client_ = running_.client({.token = "eager", .shares_memory = shares()});
  // A ring tells the server of nothing; without one each commit is a call.
  const int64_t held = shares() ? 200 : 10;
  for (int64_t at = 1; at <= held; ++at) ASSERT_OK(commit(kLeft, at, 10));
  const auto attention = running_.server->service().attend(kLeft);
  ASSERT_OK(attention);
  EXPECT_EQ(counts().passed, static_cast<uint64_t>(held));
  EXPECT_EQ(counts().refused, 0u);
}

TEST_P(Sensory, RedactsWhatPasses) {
  running_.with_store();
  ltm::EntityRule rule{"cameras", *ltm::EntityPattern::parse("Vision"), {}, {}, {}, {}};
  rule.pack.rules = {ltm::PackRule{.codec = "none"}};
  rule.redact = ltm::testing::marker_redaction(running_.folder.path(), "finds");
  running_.options.service.store->recording.rules = {rule};
  start();
  for (int64_t at = 1; at <= 3; ++at)
    ASSERT_OK(client_->commit(
        RunningServer::commit(kLeft, at, ltm::testing::image_with_secret(320, 240, 20, 5))));
  const auto result = running_.client()->query(*ltm::Query::parse("Vision @ all"));
  ASSERT_OK(result);
  ASSERT_EQ(result->entities().size(), 1u);
  ASSERT_EQ(result->entities()[0]->snapshots.size(), 3u);
  for (const auto& snapshot : result->entities()[0]->snapshots)
    EXPECT_FALSE(ltm::testing::has_secret(*snapshot.instances[0].data.get_if<idf::NdArray>()));
  EXPECT_EQ(counters().redaction.redacted, 3u);
}

TEST_P(Sensory, OthersNeedNotWaitUntilWhatAQueryAsksForHasPassed) {
  running_.with_store();
  ltm::EntityRule rule{"cameras", *ltm::EntityPattern::parse("Vision"), {}, {}, {}, {}};
  rule.pack.rules = {ltm::PackRule{.codec = "none"}};
  rule.redact = ltm::testing::marker_redaction(running_.folder.path(), "silent");
  running_.options.service.store->recording.rules = {rule};
  start();
  ASSERT_OK(client_->commit(
      RunningServer::commit(kLeft, 1, ltm::testing::image_with_secret(320, 240, 20, 5))));
  const auto asking = running_.client();
  ASSERT_OK(asking->commit(RunningServer::commit("Robot/a/b/c", 1)));
  std::atomic<bool> is_answered{false};
  asking->query(*ltm::Query::parse("Vision @ latest"), {},
                [&is_answered](const Result<ltm::QueryResult>& /*answer*/) { is_answered = true; });
  EXPECT_OK(asking->query(*ltm::Query::parse("Robot @ latest")));
  EXPECT_FALSE(is_answered);
  const SteadyTime end = steady_now() + 20s;
  while (!is_answered && steady_now() < end) std::this_thread::sleep_for(5ms);
  EXPECT_TRUE(is_answered);
}

TEST_P(Sensory, OpensExactlyWhileAClientWrites) {
  start();
  constexpr int kOpenings = 2000;
  std::atomic<int64_t> last{0};
  std::atomic<bool> is_over{false};
  std::jthread provider([&] {
    for (int64_t at = 1; !is_over; ++at) {
      ASSERT_OK(client_->commit(RunningServer::commit(kLeft, at)));
      ASSERT_OK(client_->commit(RunningServer::commit(kRight, at)));
      last = 2 * at;
      if (at % 8 == 0) std::this_thread::sleep_for(100us);
    }
  });
  memory::MemoryService& service = running_.server->service();
  // The ring has images of the other eye, too, to which somebody attends all the time.
  const auto other = service.attend(kRight);
  ASSERT_OK(other);
  while (last < 100) std::this_thread::sleep_for(1ms);
  for (int i = 0; i < kOpenings; ++i) {
    const int64_t before = last;
    auto attention = service.attend(kLeft);
    ASSERT_OK(attention);
    ASSERT_GE(static_cast<int64_t>(counters().memory.committed), before) << i;
    if (i % 16 == 0) std::this_thread::sleep_for(300us);
    const int64_t during = last;
    ASSERT_GE(static_cast<int64_t>(counters().memory.committed), during) << i;
    attention->end();
    if (i % 4 == 0) std::this_thread::sleep_for(200us);
  }
  is_over = true;
  provider.join();
  const auto attention = service.attend(kLeft);
  ASSERT_OK(attention);
  const ltm::MemoryCounters memory = counters().memory;
  EXPECT_EQ(static_cast<int64_t>(memory.committed), last) << "nothing is lost, and nothing twice";
  EXPECT_EQ(memory.superseded, 0u);
  EXPECT_EQ(counts().refused, 0u);
  EXPECT_EQ(counts().lost(), 0u);
}

}  // namespace
}  // namespace engram::server
