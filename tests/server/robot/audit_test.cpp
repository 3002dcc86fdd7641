// SPDX-License-Identifier: Apache-2.0
// What a server notes of its clients.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "server/access/audit_check.h"
#include "tests/ltm/expect_status.h"
#include "tests/server/access/secret_file.h"
#include "tests/server/robot/running_server.h"

namespace engram::server {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::RunningServer;

/// Files can grow to this size while it lives.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) : before_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit less{bytes, limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &less);
  }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;
  ~FileLimit() {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }

 private:
  rlimit limit_{};
  void (*before_)(int);
};

class AuditedServer : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_OK(AuditLog::create(log_path()));
    std::string tokens = "tokens:\n";
    for (const auto& [name, rights] : std::vector<std::pair<std::string, std::string>>{
             {"owner", "role: admin, memories: all"},
             {"guest", "role: read, memories: [Hall]"},
             {"eager", "role: read, memories: [Hall], rate: 1Hz"}})
      tokens += fmt::format("  - {{name: {}, token_sha256: {}, {}}}\n", name,
                            to_hex(hash_token(name)), rights);
    running_.options.tokens = testing::write_secret(running_.folder.path() / "tokens.yaml", tokens);
    start();
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

  /// "WHO DID ON", with "!" in front of what was refused.
  [[nodiscard]] std::vector<std::string> records() const {
    const auto bytes = read_file(log_path());
    EXPECT_OK(bytes);
    std::istringstream text{std::string(as_text(bytes->bytes()))};
    std::vector<std::string> all;
    for (std::string line; std::getline(text, line);) {
      const auto json = nlohmann::json::parse(line);
      EXPECT_EQ(json["server"], "test");
      all.push_back(fmt::format("{}{} {} {}", json.contains("refused") ? "!" : "",
                                json["who"].get<std::string>(), json["did"].get<std::string>(),
                                json["on"].get<std::string>()));
    }
    return all;
  }

  void expect_whole() const {
    const auto report = check_audit_log(log_path(), AuditLog::key_path(log_path()), {}, {});
    ASSERT_OK(report);
    EXPECT_TRUE(report->is_whole()) << report->flaws.front().what;
  }

  RunningServer running_;
};

const ltm::MemoryId kBed = *ltm::MemoryId::parse("Bedroom/b/c/bed");
const std::vector<Duration> kHorizons{std::chrono::seconds(1)};

TEST_F(AuditedServer, NotesWhoAskedWhat) {
  const auto owner = client("owner");
  for (int64_t at = 1; at <= 3; ++at)
    ASSERT_OK(owner->commit(RunningServer::commit("Bedroom/b/c/bed", at)));
  ASSERT_OK(owner->declare(*ltm::MemoryId::parse("Bedroom/b"), idf::Type::int64()));
  const auto guest = client("guest");
  EXPECT_FAILS(guest->query(*ltm::Query::parse(".* @ latest")), StatusCode::kNotFound,
               "it has: none");
  const auto predicted = guest->predict(kBed, kHorizons, {});
  EXPECT_FALSE(predicted.ok());
  EXPECT_FALSE(guest->engines(kBed, kHorizons).ok());
  EXPECT_FALSE(guest->commit(RunningServer::commit("Bedroom/b/c/bed", 9)).ok());
  EXPECT_FALSE(client("stranger")->query(*ltm::Query::parse("Hall")).ok());
  {
    const auto subscription = guest->subscribe({.names = {"Bedroom"}}, {});
    ASSERT_OK(subscription);
  }
  stop();
  const auto noted = records();
  EXPECT_THAT(noted.front(), HasSubstr(" serve unix:"));
  EXPECT_EQ(noted.back(), " stop ");
  // A stream notes an entity once.
  EXPECT_EQ(std::ranges::count(noted, "owner commit Bedroom/b/c/bed"), 1);
  for (const char* one : {"owner declare Bedroom/b", "guest query .*/.*/.*/.* @ latest",
                          "!guest predict Bedroom/b/c/bed", "!guest engines Bedroom/b/c/bed",
                          "!guest commit Bedroom/b/c/bed", "guest subscribe Bedroom"})
    EXPECT_THAT(noted, Contains(one));
  EXPECT_THAT(noted, Contains(::testing::StartsWith("! connect unix:")));
  expect_whole();
}

TEST_F(AuditedServer, NotesWhoReadsSharedMemory) {
  const auto owner = client("owner");
  const auto guest = client("guest");
  std::atomic<int> told = 0;
  const auto subscribe = [&told](MemoryClient& by) {
    SubscriptionHandlers handlers;
    handlers.on_snapshots = [&told](const std::vector<ToldSnapshot>& snapshots) {
      told += static_cast<int>(snapshots.size());
    };
    return by.subscribe({.names = {}, .with_data = true}, std::move(handlers));
  };
  const auto of_owner = subscribe(*owner);
  const auto of_guest = subscribe(*guest);
  ASSERT_OK(of_owner);
  ASSERT_OK(of_guest);
  const idf::Data large = idf::NdArray::take({1 << 20}, std::vector<uint8_t>(1 << 20));
  // The guest may see one of them.
  ASSERT_OK(owner->commit(RunningServer::commit("Bedroom/b/c/bed", 1, large)));
  ASSERT_OK(owner->commit(RunningServer::commit("Hall/b/c/door", 2, large)));
  for (int i = 0; i < 1000 && told < 3; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(told, 3);
  stop();
  const auto noted = records();
  for (const char* one : {"owner share Bedroom", "owner share Hall", "guest share Hall"})
    EXPECT_EQ(std::ranges::count(noted, one), 1) << one;
  EXPECT_EQ(std::ranges::count(noted, "guest share Bedroom"), 0);
  expect_whole();
}

TEST_F(AuditedServer, IsNotFilledByWhoIsRefused) {
  const auto eager = client("eager");
  const auto stranger = client("stranger");
  for (int i = 0; i < 300; ++i) {
    [[maybe_unused]] const auto refused = eager->query(*ltm::Query::parse("Hall"));
    EXPECT_FALSE(stranger->query(*ltm::Query::parse("Hall")).ok());
  }
  stop();
  const auto noted = records();
  EXPECT_THAT(noted, Contains(HasSubstr("!eager query")));
  EXPECT_LT(noted.size(), 60U);
  expect_whole();
}

TEST_F(AuditedServer, AnswersNothingThatCannotBeNoted) {
  const auto owner = client("owner");
  ASSERT_OK(owner->commit(RunningServer::commit("Bedroom/b/c/bed", 1)));
  ASSERT_OK(owner->query(*ltm::Query::parse("Bedroom")));
  const auto size = std::filesystem::file_size(log_path());
  {
    const FileLimit limit(size + 20);
    EXPECT_FAILS(owner->query(*ltm::Query::parse("Bedroom")), StatusCode::kFailedPrecondition,
                 "audit.log");
    EXPECT_FAILS(owner->engines(kBed, kHorizons), StatusCode::kFailedPrecondition, "audit.log");
    EXPECT_FALSE(owner->predict(kBed, kHorizons, {}).ok());
    EXPECT_FALSE(owner->subscribe({.names = {"Bedroom"}}, {}).ok());
    EXPECT_FALSE(owner->commit(RunningServer::commit("Bedroom/b/c/other", 1)).ok());
  }
  EXPECT_EQ(std::filesystem::file_size(log_path()), size) << "no part of a record stays";
  EXPECT_OK(owner->query(*ltm::Query::parse("Bedroom")));
  stop();
  expect_whole();
}

TEST_F(AuditedServer, GoesOnAfterARestart) {
  ASSERT_OK(client("owner")->commit(RunningServer::commit("Hall/b/c/d", 1)));
  stop();
  start();
  stop();
  EXPECT_THAT(records(), ElementsAre(HasSubstr(" serve unix:"), "owner commit Hall/b/c/d", " stop ",
                                     HasSubstr(" serve unix:"), " stop "));
  expect_whole();
}

}  // namespace
}  // namespace engram::server
