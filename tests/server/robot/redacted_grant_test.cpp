// SPDX-License-Identifier: Apache-2.0
// What those see who may see images redacted only.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

#include "ltm/idf/binary.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/server/access/secret_file.h"
#include "tests/server/robot/running_server.h"

namespace engram::server {
namespace {

using ltm::testing::has_secret;
using ltm::testing::image_with_secret;
using ::testing::HasSubstr;
using testing::RunningServer;

constexpr const char* kCamera = "Vision/RGB/head/hall_cam";
constexpr int64_t kImages = 12;

Time image_time(int64_t i) {
  return time_from_ns((1'000 + i) * 1'000'000'000);
}

/// Whether any value of an answer holds the secret.
bool shows_secret(const ltm::QueryResult& result) {
  for (const ltm::EntityResult* entity : result.entities())
    for (const ltm::SnapshotResult& snapshot : entity->snapshots)
      for (const ltm::InstanceResult& instance : snapshot.instances) {
        const auto bytes = idf::encode(instance.data);
        EXPECT_TRUE(bytes.ok());
        if (bytes.ok() && has_secret(as_text(*bytes))) return true;
      }
  return false;
}

size_t count_of(const ltm::QueryResult& result) {
  size_t count = 0;
  for (const ltm::EntityResult* entity : result.entities()) count += entity->snapshots.size();
  return count;
}

/// A camera that sees a secret in every image, and a counter beside it.
class RedactedGrants : public ::testing::TestWithParam<bool> {
 protected:
  void start(const std::string& mode) {
    const auto command = ltm::testing::marker_program(running_.folder.path(), mode);
    std::string tokens = fmt::format(
        "redact: {{detector: {{program: ['{}']}}, action: fill, grow: 0, timeout: {}}}\n"
        "tokens:\n",
        fmt::join(command, "', '"), mode == "finds" ? "20s" : "500ms");
    const std::string late = "'" + engram::to_string(image_time(6)) + "'";
    for (const auto& [name, grants] : std::vector<std::pair<std::string, std::string>>{
             {"owner", "role: admin, memories: all"},
             {"visitor", "grants: [{ids: all, may: [read], form: redacted}]"},
             {"guard",
              "grants: [{ids: all, may: [read], form: redacted}, {ids: [Vision], may: "
              "[read], form: exact, from: " +
                  late + "}]"}})
      tokens += fmt::format("  - {{name: {}, token_sha256: {}, {}}}\n", name,
                            to_hex(hash_token(name)), grants);
    running_.options.tokens = testing::write_secret(running_.folder.path() / "tokens.yaml", tokens);
    running_.options.sharing.emplace();
    if (GetParam()) {
      running_.with_store();
      running_.options.service.memory.all.snapshots = kImages;  // Of two entities.
    }
    running_.start();
    owner_ = client("owner");
    for (int64_t i = 0; i < kImages; ++i) {
      const auto image = image_with_secret(160, 120, static_cast<int>(5 * i), 40);
      ASSERT_OK(owner_->commit(RunningServer::commit(kCamera, to_ns(image_time(i)),
                                                     idf::Dict{{"image", image}, {"number", i}})));
      ASSERT_OK(owner_->commit(RunningServer::commit("Robot/a/b/count", to_ns(image_time(i)), i)));
    }
  }

  [[nodiscard]] std::unique_ptr<MemoryClient> client(const std::string& token) const {
    return running_.client({.token = token});
  }

  static ltm::QueryResult ask(MemoryClient& client, const std::string& query) {
    auto answer = client.query(*ltm::Query::parse(query));
    EXPECT_TRUE(answer.ok()) << answer.status().to_string();
    return answer.ok() ? *std::move(answer) : ltm::QueryResult(false);
  }

  RunningServer running_;
  std::unique_ptr<MemoryClient> owner_;
};

TEST_P(RedactedGrants, ShowNoSecretInAnyAnswer) {
  start("finds");
  const auto visitor = client("visitor");
  for (const char* query :
       {".* @ all", "Vision/RGB/head/hall_cam @ latest", "Vision @ latest:3", "Vision @ index:0..1",
        "Vision/RGB/head/hall_cam @ all#0", "Vision @ 1970-01-01T00:16:45Z",
        "Vision @ until:1970-01-01T00:16:45Z", "Vision @ latest, +1s"}) {
    const ltm::QueryResult all = ask(*owner_, query);
    const ltm::QueryResult seen = ask(*visitor, query);
    EXPECT_TRUE(shows_secret(all)) << query;
    EXPECT_FALSE(shows_secret(seen)) << query;
    if (std::string(query).find("+1s") == std::string::npos) {
      EXPECT_EQ(count_of(seen), count_of(all)) << query;
    }
  }
  // All else of a snapshot is as it is.
  const ltm::QueryResult one = ask(*visitor, "Vision/RGB/head/hall_cam @ index:3..3");
  const idf::Data& value = one.entities()[0]->snapshots[0].instances[0].data;
  EXPECT_EQ(value.at("number")->get<int64_t>(), 3);
  const auto* image = value.at("image")->get_if<idf::NdArray>();
  ASSERT_NE(image, nullptr);
  EXPECT_EQ(image->bytes()[0], std::byte{90});
  EXPECT_THAT(owner_->info()->figures_json, HasSubstr("\"answers_redacted\":"));
  // What was answered redacted is not what is kept.
  EXPECT_TRUE(shows_secret(ask(*owner_, ".* @ all")));
}

TEST_P(RedactedGrants, ShowImagesAsTheyAreOfTheTimesThatAnotherGrantGives) {
  start("finds");
  const auto guard = client("guard");
  EXPECT_FALSE(shows_secret(ask(*guard, "Vision @ index:0..5")));
  for (int64_t i = 6; i < kImages; ++i)
    EXPECT_TRUE(shows_secret(ask(*guard, fmt::format("Vision @ index:{}..{}", i, i)))) << i;
  EXPECT_EQ(count_of(ask(*guard, "Vision @ all")), static_cast<size_t>(kImages));
}

TEST_P(RedactedGrants, LeaveOutWhatNobodyCouldLookAt) {
  start("silent");
  const auto visitor = client("visitor");
  EXPECT_EQ(count_of(ask(*visitor, "Vision @ latest")), 0u);
  EXPECT_EQ(count_of(ask(*visitor, "Robot @ all")), static_cast<size_t>(kImages));
  EXPECT_THAT(owner_->info()->figures_json, HasSubstr("\"answers_withheld\":1"));
}

TEST_P(RedactedGrants, TellSubscribersOfImagesWithoutTheirData) {
  start("finds");
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<ToldSnapshot> told;
  SubscriptionHandlers handlers;
  handlers.on_snapshots = [&](std::vector<ToldSnapshot> snapshots) {
    const std::scoped_lock lock(mutex);
    for (ToldSnapshot& one : snapshots) told.push_back(std::move(one));
    changed.notify_all();
  };
  const auto visitor = client("visitor");
  const auto subscription = visitor->subscribe({.names = {}, .with_data = true}, handlers);
  ASSERT_OK(subscription);
  const auto owner = client("owner");
  ASSERT_OK(owner->commit(RunningServer::commit(
      kCamera, to_ns(image_time(50)),
      idf::Dict{{"image", image_with_secret(160, 120, 5, 5)}, {"number", int64_t{50}}})));
  std::unique_lock lock(mutex);
  ASSERT_TRUE(changed.wait_for(lock, std::chrono::seconds(20), [&] { return !told.empty(); }));
  EXPECT_FALSE(told[0].has_data);
  EXPECT_EQ(told[0].snapshot.time, image_time(50));
}

TEST_P(RedactedGrants, GiveNothingElse) {
  start("finds");
  const auto visitor = client("visitor");
  const std::vector<Duration> ahead{std::chrono::seconds(1)};
  EXPECT_FALSE(visitor->predict(*ltm::MemoryId::parse(kCamera), ahead, {}).ok());
  EXPECT_FALSE(visitor->engines(*ltm::MemoryId::parse(kCamera), ahead).ok());
  EXPECT_FALSE(visitor->commit(RunningServer::commit(kCamera, 1)).ok());
}

TEST_P(RedactedGrants, CompareNoImagesButThoseThatMayBeSeenAsTheyAre) {
  start("finds");
  const auto visitor = client("visitor"), guard = client("guard");
  ltm::SimilarRequest request{.entity = *ltm::MemoryId::parse(kCamera), .moment = image_time(8)};
  if (!GetParam()) {
    EXPECT_FAILS(owner_->similar(request), StatusCode::kFailedPrecondition, "has no store");
    return;
  }
  EXPECT_EQ(owner_->similar(request)->compared, static_cast<uint64_t>(kImages));
  EXPECT_FAILS(visitor->similar(request), StatusCode::kFailedPrecondition, "redacted only");
  EXPECT_EQ(guard->similar(request)->compared, 6u);
  for (const ltm::SimilarMoment& moment : guard->similar(request)->moments) {
    EXPECT_GE(moment.time, image_time(6));
    EXPECT_EQ(moment.recording_first, image_time(6));
  }
  request.moment = image_time(3);
  const auto hidden = guard->similar(request);
  EXPECT_FAILS(hidden, StatusCode::kNotFound,
               "the moment before it is none, after it " + engram::to_string(image_time(6)));
  // An image of the caller's own tells of what it is compared with, too.
  request = {.entity = *ltm::MemoryId::parse(kCamera), .image = image_with_secret(160, 120, 5, 5)};
  EXPECT_FALSE(visitor->similar(request).ok());
  EXPECT_EQ(guard->similar(request)->compared, 6u);
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutAStore, RedactedGrants, ::testing::Bool(),
                         [](const auto& one) { return one.param ? "Store" : "Memory"; });

}  // namespace
}  // namespace engram::server
