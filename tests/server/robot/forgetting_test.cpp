// SPDX-License-Identifier: Apache-2.0
// What a server forgets for its clients: for whom, how much, and that nothing of it comes back.
#include <engram/v1/memory.grpc.pb.h>
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "ltm/idf/json.h"
#include "server/robot/names_server.h"
#include "tests/ltm/expect_status.h"
#include "tests/server/access/secret_file.h"
#include "tests/server/robot/running_server.h"

namespace engram::server {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::RunningServer;

constexpr const char* kLamp = "Hall/a/b/lamp";
constexpr const char* kBed = "Bedroom/a/b/bed";
constexpr const char* kCanary = "canary-that-nobody-may-find-again";
constexpr int64_t kCount = 20;

/// Snapshot `i`, ten a second.
Time time_of(int64_t i) {
  return time_from_ns(1'000'000'000'000 + i * 100'000'000);
}

std::string text_of(int64_t i) {
  return "'" + engram::to_string(time_of(i)) + "'";
}

class Forgetting : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    const std::vector<std::pair<std::string, std::string>> holders{
        {"owner", "role: admin, memories: all"},
        {"writer", "role: write, memories: all"},
        {"reader", "role: read, memories: all"},
        {"eraser", "grants: [{ids: [Hall], may: [erase]}]"},
        {"window", "grants: [{ids: [Hall], may: [read, erase], from: " + text_of(5) +
                       ", until: " + text_of(9) + "}, {ids: [Bedroom], may: [read]}]"},
        {"deep", "grants: [{ids: [Hall/a/b/lamp], may: [erase]}]"}};
    std::string tokens = "tokens:\n";
    for (const auto& [name, rights] : holders)
      tokens += fmt::format("  - {{name: {}, token_sha256: {}, {}}}\n", name,
                            to_hex(hash_token(name)), rights);
    running_.options.tokens = testing::write_secret(running_.folder.path() / "tokens.yaml", tokens);
    ASSERT_OK(AuditLog::create(log_path()));
    if (GetParam()) {
      running_.with_store();
      running_.options.service.memory.all.snapshots = 16;  // Of forty: the others are stored.
    }
    start();
    const auto owner = client("owner");
    for (int64_t i = 0; i < kCount; ++i)
      for (const char* entity : {kLamp, kBed})
        ASSERT_OK(owner->commit(RunningServer::commit(
            entity, to_ns(time_of(i)),
            idf::Dict{{"x", entity == kLamp ? 1e6 : 0.5}, {"text", value_of(entity, i)}})));
  }

  static std::string value_of(const std::string& entity, int64_t i) {
    return entity == kLamp ? fmt::format("{} {}", kCanary, i) : fmt::format("harmless {}", i);
  }

  void start() {
    auto log = AuditLog::open(log_path());
    ASSERT_OK(log);
    running_.options.audit = *std::move(log);
    running_.start();
  }

  void stop() {
    ASSERT_OK(running_.server->stop());
    running_.server.reset();
    running_.options.audit.reset();
  }

  [[nodiscard]] std::filesystem::path log_path() const {
    return running_.folder.path() / "audit.log";
  }

  [[nodiscard]] std::unique_ptr<MemoryClient> client(const std::string& token) const {
    return running_.client({.token = token});
  }

  Result<Forgotten> forget(const std::string& who, const std::vector<std::string>& targets,
                           bool erases = false, bool is_dry_run = false) {
    return client(who)->forget({.targets = targets, .erases = erases, .is_dry_run = is_dry_run});
  }

  /// How many snapshots there are of an entity.
  size_t count(const std::string& entity) {
    const auto answer = client("owner")->query(*ltm::Query::parse("?ids " + entity + " @ all"));
    if (answer.status().code() == StatusCode::kNotFound) return 0;
    EXPECT_OK(answer);
    return answer.ok() ? answer->snapshot_count() : 0;
  }

  /// Whether any file of the store has these bytes.
  [[nodiscard]] bool has_bytes(const std::string& bytes) const {
    if (!GetParam()) return false;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(running_.store())) {
      if (!entry.is_regular_file()) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string content((std::istreambuf_iterator<char>(file)), {});
      if (content.find(bytes) != std::string::npos) return true;
    }
    return false;
  }

  /// All that a client is told of anything, as text.
  std::string told_of_everything() {
    const auto owner = client("owner");
    std::string all;
    for (const char* query : {".* @ all", ".* @ latest", ".* @ latest:5", ".* @ index:0..9",
                              "?ids .* @ all", ".* @ +200ms", "Hall/.*/.*/.* @ latest, +1s"}) {
      const auto answer = owner->query(*ltm::Query::parse(query));
      if (!answer.ok()) continue;
      for (const ltm::EntityResult* entity : answer->entities()) {
        all += entity->id.to_string() + "\n";
        for (const ltm::SnapshotResult& snapshot : entity->snapshots)
          for (const ltm::InstanceResult& instance : snapshot.instances)
            all += idf::to_json_text(instance.data).value_or("") + "\n";
      }
    }
    return all;
  }

  RunningServer running_;
};

TEST_P(Forgetting, NothingOfItComesBack) {
  const std::vector<Duration> ahead{std::chrono::milliseconds(200)};
  const auto lamp = *ltm::MemoryId::parse(kLamp);
  ASSERT_OK(client("owner")->predict(lamp, ahead, {}));
  EXPECT_THAT(told_of_everything(), HasSubstr(kCanary));
  const auto done = forget("owner", {kLamp}, true);
  ASSERT_OK(done);
  EXPECT_EQ(done->snapshots, uint64_t{kCount});
  ASSERT_EQ(done->entities.size(), 1u);
  EXPECT_EQ(done->entities[0].entity, kLamp);
  EXPECT_EQ(done->entities[0].first, time_of(0));
  EXPECT_EQ(done->entities[0].last, time_of(kCount - 1));
  EXPECT_EQ(done->erased_json.empty(), !GetParam());
  const auto check = [&] {
    EXPECT_THAT(told_of_everything(), Not(HasSubstr(kCanary)));
    EXPECT_THAT(told_of_everything(), Not(HasSubstr(kLamp)));
    EXPECT_EQ(client("owner")->predict(lamp, ahead, {}).status().code(), StatusCode::kNotFound);
    EXPECT_FALSE(has_bytes(kCanary));
    EXPECT_EQ(count(kBed), GetParam() || running_.server ? size_t{kCount} : 0);
  };
  check();
  stop();
  EXPECT_FALSE(has_bytes(kCanary));
  if (!GetParam()) return;
  start();
  check();
}

TEST_P(Forgetting, PredictionsGoOnFromWhatIsLeft) {
  const auto lamp = *ltm::MemoryId::parse(kLamp);
  const std::vector<Duration> ahead{std::chrono::milliseconds(100)};
  const auto owner = client("owner");
  for (int64_t i = kCount; i < 2 * kCount; ++i)
    ASSERT_OK(owner->commit(
        RunningServer::commit(kLamp, to_ns(time_of(i)), idf::Dict{{"x", -3.0}, {"text", "new"}})));
  const auto engines = owner->engines(lamp, ahead);
  ASSERT_OK(engines);
  ASSERT_OK(forget("owner", {fmt::format("{} @ until:{}", kLamp, to_ns(time_of(kCount - 1)))}));
  for (const ltm::EngineRecord& record : engines->front()) {
    const auto predicted = owner->predict(lamp, ahead, {.engine = record.engine});
    ASSERT_OK(predicted);
    const idf::Data& value = predicted->front().instances.at(0).data;
    EXPECT_NEAR(value.at("x")->get<double>(), -3.0, 0.5) << record.engine;
    EXPECT_THAT(idf::to_json_text(value).value_or(""), Not(HasSubstr(kCanary)));
  }
}

TEST_P(Forgetting, NeedsTheRightToErase) {
  for (const char* who : {"writer", "reader"})
    for (const std::string target : {"Hall", kLamp, "Hall/.*/b/lamp @ all"}) {
      const auto refused = forget(who, {target});
      EXPECT_FAILS(refused, StatusCode::kFailedPrecondition,
                   fmt::format("'{}' may erase nothing", who));
    }
  const std::string in_window = fmt::format("{}/{}", kLamp, engram::to_string(time_of(7)));
  const std::string outside = fmt::format("{}/{}", kLamp, engram::to_string(time_of(2)));
  EXPECT_FAILS(forget("window", {outside}), StatusCode::kFailedPrecondition, "may not erase");
  EXPECT_FAILS(forget("window", {kBed}), StatusCode::kFailedPrecondition, "may not erase");
  EXPECT_FAILS(forget("eraser", {kLamp, kBed}), StatusCode::kFailedPrecondition, "may not erase");
  EXPECT_FAILS(forget("deep", {"Bedroom"}), StatusCode::kFailedPrecondition, "may not erase");
  EXPECT_FAILS(forget("stranger", {kLamp}), StatusCode::kFailedPrecondition, "not known");
  EXPECT_EQ(count(kLamp), size_t{kCount});
  EXPECT_EQ(count(kBed), size_t{kCount});
  ASSERT_OK(forget("window", {in_window}));
  EXPECT_EQ(count(kLamp), size_t{kCount - 1});
}

TEST_P(Forgetting, PatternsLeaveOutWhatMayNotBeErased) {
  const auto counted = forget("window", {".* @ all"}, false, true);
  ASSERT_OK(counted);
  EXPECT_EQ(counted->snapshots, 5u);
  EXPECT_EQ(counted->entities.size(), 1u);
  EXPECT_EQ(count(kLamp), size_t{kCount}) << "it only counted";
  // The last one that may be erased is not the last one.
  const auto last = forget("window", {"Hall/.*/.*/.* @ latest"});
  ASSERT_OK(last);
  EXPECT_EQ(last->entities.at(0).first, time_of(9));
  ASSERT_OK(forget("window", {".* @ all"}, GetParam()));
  EXPECT_EQ(count(kLamp), size_t{kCount - 5});
  EXPECT_EQ(count(kBed), size_t{kCount});
  EXPECT_FAILS(forget("window", {".* @ all"}), StatusCode::kNotFound, "that may be erased");
  // Erasing needs no right to read.
  EXPECT_FALSE(client("deep")->query(*ltm::Query::parse(kLamp)).ok());
  ASSERT_OK(forget("deep", {"Hall"}));
  EXPECT_EQ(count(kLamp), 0u);
  EXPECT_EQ(count(kBed), size_t{kCount});
}

// The subscriber reads nothing, so that most of what it is to be told waits in the server.
TEST_P(Forgetting, SubscribersAreNotToldWhatWaitedForThem) {
  const auto channel = grpc::CreateChannel(running_.endpoint(), grpc::InsecureChannelCredentials());
  const auto stub = v1::MemoryServer::NewStub(channel);
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer owner");
  const auto stream = stub->Subscribe(&context);
  v1::SubscribeRequest wanted;
  wanted.add_names("Hall");
  wanted.set_with_data(true);
  ASSERT_TRUE(stream->Write(wanted));
  v1::Notification told;
  ASSERT_TRUE(stream->Read(&told));
  ASSERT_TRUE(told.is_started());
  const auto owner = client("owner");
  constexpr int kLarge = 48;
  const idf::Data large = idf::NdArray::take({1 << 20}, std::vector<uint8_t>(1 << 20, 7));
  for (int i = 1; i <= kLarge; ++i)
    ASSERT_OK(owner->commit(RunningServer::commit("Hall/a/b/picture", i, large)));
  ASSERT_OK(forget("owner", {"Hall/a/b/picture"}));
  ASSERT_OK(owner->commit(RunningServer::commit("Hall/a/b/end", 1)));
  int pictures = 0;
  for (bool is_ended = false; !is_ended;) {
    ASSERT_TRUE(stream->Read(&told));
    EXPECT_EQ(told.lost(), 0u);
    for (const v1::Snapshot& event : told.events()) {
      pictures += event.entity() == "Hall/a/b/picture" ? 1 : 0;
      is_ended = is_ended || event.entity() == "Hall/a/b/end";
    }
  }
  EXPECT_LT(pictures, kLarge - 10);
  context.TryCancel();
}

TEST_P(Forgetting, IsNotedAndCounted) {
  ASSERT_OK(forget("owner", {kLamp, "Bedroom @ latest:2"}, true));
  ASSERT_OK(forget("owner", {kBed}, false, true));
  EXPECT_FALSE(forget("writer", {kBed}).ok());
  const auto figures = nlohmann::json::parse(client("owner")->info()->figures_json);
  EXPECT_GE(figures["memory_forgotten"].get<int>(), 2);
  EXPECT_THAT(*client("owner")->metrics(), HasSubstr("engram_forgettings_total 2"));
  stop();
  std::ifstream log(log_path());
  std::vector<std::string> noted;
  for (std::string line; std::getline(log, line);) {
    const auto json = nlohmann::json::parse(line);
    noted.push_back(fmt::format("{}{} {} {}", json.contains("refused") ? "!" : "",
                                json["who"].get<std::string>(), json["did"].get<std::string>(),
                                json["on"].get<std::string>()));
  }
  EXPECT_THAT(noted, Contains("owner forget Hall/a/b/lamp ; Bedroom @ latest:2 (erase)"));
  EXPECT_THAT(noted, Contains("owner count to forget Bedroom/a/b/bed"));
  EXPECT_THAT(noted, Contains("!writer forget Bedroom/a/b/bed"));
}

TEST_P(Forgetting, EndsWithTheCall) {
  std::stop_source stop;
  stop.request_stop();
  const auto cancelled = client("owner")->forget({.targets = {"Hall"}, .stop = stop.get_token()});
  EXPECT_EQ(cancelled.status().code(), StatusCode::kCancelled);
  // The server takes the next one as soon as that has ended.
  Result<Forgotten> next = forget("owner", {kBed});
  for (int i = 0; i < 500 && !next.ok(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    next = forget("owner", {kBed});
  }
  ASSERT_OK(next);
  EXPECT_EQ(count(kBed), 0u);
}

TEST_P(Forgetting, EndsWithTheServer) {
  std::jthread forgetting([this] {
    const auto owner = client("owner");
    while (true) {
      const auto done = owner->forget({.targets = {"Hall @ latest"}});
      if (!done.ok() && done.status().code() != StatusCode::kNotFound) return;
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  stop();
  forgetting.join();
  if (!GetParam()) return;
  start();
  EXPECT_EQ(count(kBed), size_t{kCount});
}

TEST_P(Forgetting, WantsTargetsThatCanBeRead) {
  EXPECT_FAILS(forget("owner", {}), StatusCode::kInvalidArgument, "nothing to forget");
  EXPECT_FAILS(forget("owner", {""}), StatusCode::kInvalidArgument, "found ''");
  EXPECT_FAILS(forget("owner", {"Hall @ sometimes"}), StatusCode::kInvalidArgument, "sometimes");
  EXPECT_FAILS(forget("owner", {"Hall @ time:5..6"}), StatusCode::kNotFound, "names no snapshot");
  EXPECT_FAILS(forget("owner", {"(/a/b/c @ all"}), StatusCode::kInvalidArgument, "(");
  EXPECT_EQ(count(kLamp), size_t{kCount});
}

TEST_P(Forgetting, OthersCommitMeanwhile) {
  std::jthread committing([this](const std::stop_token& stop) {
    const auto owner = client("owner");
    for (int64_t i = 0; !stop.stop_requested(); ++i)
      ASSERT_OK(owner->commit(
          RunningServer::commit("Yard/a/b/tree", i + 1),
          GetParam() && i % 5 == 0 ? CommitDurability::kJournal : CommitDurability::kMemory));
  });
  for (int round = 0; round < 4; ++round) {
    ASSERT_OK(forget("owner", {"Hall @ latest:3"}, round % 2 == 0));
    EXPECT_EQ(count(kLamp), size_t(kCount - 3 * (round + 1)));
  }
  committing = {};
  const size_t trees = count("Yard/a/b/tree");
  EXPECT_GT(trees, 0u);
  if (!GetParam()) return;
  stop();
  start();
  EXPECT_EQ(count("Yard/a/b/tree"), trees);
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutAStore, Forgetting, ::testing::Bool(),
                         [](const auto& suite) { return suite.param ? "Store" : "NoStore"; });

TEST(ForgettingOfOldServers, IsRefusedInWords) {
  const ScratchDirectory folder;
  const std::string endpoint = "unix:" + (folder.path() / "n").string();
  NamesServer::Options options;
  options.rpc.endpoints = {*Endpoint::parse(endpoint)};
  const auto names = NamesServer::start(options);
  ASSERT_OK(names);
  const auto client = MemoryClient::connect(endpoint);
  ASSERT_OK(client);
  EXPECT_FAILS((*client)->forget({.targets = {"Hall"}}), StatusCode::kFailedPrecondition,
               "is of a version that cannot forget");
}

}  // namespace
}  // namespace engram::server
