// SPDX-License-Identifier: Apache-2.0
// The same question is answered the same wherever it is asked: in the process of a server, over the
// wire, and of the store that the server leaves behind. Source: docs/query.md, section "Answers".
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <map>

#include "ltm/idf/json.h"
#include "server/client/memory_client.h"
#include "server/robot/memory_server.h"
#include "tests/conformance/answers/lived_store.h"
#include "tests/conformance/answers/questions.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram {
namespace {

using testing::commits_of_today;
using testing::engines_questions;
using testing::EnginesQuestion;
using testing::future_questions;
using testing::FutureQuestion;
using testing::latent_questions;
using testing::lived_models;
using testing::make_lived_store;
using testing::questions;

std::string error_text(const std::optional<ltm::MeasuredError>& error) {
  return error ? fmt::format("{}/{}", error->image_mse, error->number_mse) : "-";
}

void add_instance(const ltm::InstanceResult& instance, std::string& text) {
  const auto data = idf::to_json_text(instance.data);
  const ltm::InstanceMetadata& metadata = instance.metadata;
  text += fmt::format(
      "    #{} {} error {} bound {} by '{}' confidence {} created {} sent {} arrived {}\n",
      instance.index, data.ok() ? *data : data.status().to_string(), error_text(instance.error),
      error_text(instance.bound), metadata.provider, metadata.confidence, to_ns(metadata.created),
      to_ns(metadata.sent), to_ns(metadata.arrived));
  for (const ltm::MemberPrediction& member : instance.members)
    text += fmt::format(
        "      '{}' by '{}' error {} bound {} copied {} image {} moving {} counted {}\n",
        member.path, member.engine, member.expected_mse, member.bound_mse, member.copied,
        member.is_image, member.is_moving, member.is_counted);
}

/// Everything that an answer says, as text: a difference is read at once. Errors name the place
/// that was asked, and behind a wire first the `endpoint`: these alone may differ.
std::string text_of(const Result<ltm::QueryResult>& answer, const std::string& place,
                    const std::string& endpoint = {}) {
  if (!answer.ok()) {
    std::string message = answer.status().message();
    if (!endpoint.empty() && message.starts_with(endpoint + ": "))
      message = message.substr(endpoint.size() + 2);
    else if (!endpoint.empty())
      message = "no endpoint: " + message;
    if (const size_t at = message.find(place); at != std::string::npos)
      message.replace(at, place.size(), "PLACE");
    return fmt::format("{}: {}", to_string(answer.status().code()), message);
  }
  std::string text;
  for (const ltm::EntityResult* entity : answer->entities()) {
    text += entity->id.to_string() + "\n";
    for (const ltm::SnapshotResult& snapshot : entity->snapshots) {
      text += fmt::format("  {} {} model '{}' by '{}' horizon {} plan '{}'\n",
                          to_string(snapshot.time), to_string(snapshot.source), snapshot.model,
                          snapshot.predictor, to_string(snapshot.horizon), snapshot.plan);
      for (const ltm::InstanceResult& instance : snapshot.instances) add_instance(instance, text);
    }
  }
  return text;
}

std::string text_of(const FutureQuestion& asked,
                    const Result<std::vector<ltm::SnapshotResult>>& told, const std::string& place,
                    const std::string& endpoint = {}) {
  if (!told.ok()) return text_of(Result<ltm::QueryResult>(told.status()), place, endpoint);
  std::string text;
  for (const ltm::SnapshotResult& one : *told) {
    ltm::QueryResult alone;
    alone.add_entity(*ltm::MemoryId::parse(asked.entity)).add(one);
    text += text_of(Result<ltm::QueryResult>(alone), place);
  }
  return text;
}

std::string text_of(const Result<std::vector<ltm::EngineRecord>>& told, const std::string& place,
                    const std::string& endpoint = {}) {
  if (!told.ok()) return text_of(Result<ltm::QueryResult>(told.status()), place, endpoint);
  std::string text;
  for (const ltm::EngineRecord& one : *told)
    text += fmt::format("{} of '{}': {} predictions, mean {}, bound {}\n", one.engine, one.model,
                        one.predictions, error_text(one.mean), error_text(one.bound));
  return text;
}

using Answers = std::map<std::string, std::string>;

void add_part(ltm::QueryResult part, ltm::QueryResult& whole) {
  for (const ltm::EntityResult* entity : part.entities()) {
    ltm::EntityResult& known = whole.add_entity(entity->id);
    for (const ltm::SnapshotResult& snapshot : entity->snapshots) {
      EXPECT_TRUE(known.snapshots.empty() || known.snapshots.back().time < snapshot.time);
      known.add(snapshot);
    }
  }
}

/// The answer that comes in parts of one snapshot each. `begin` and `next` are those of
/// ltm::Recall.
template <typename Begin, typename Next>
Result<ltm::QueryResult> in_parts(const ltm::Query& query, const Begin& begin, const Next& next) {
  ltm::QueryResult whole(query.is_ids_only());
  ENGRAM_ASSIGN_OR_RETURN(ltm::Recall::AnswerCursor cursor, begin(query));
  while (!cursor.is_done()) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Answer part, next(cursor));
    add_part(std::move(part).to_result(), whole);
  }
  return whole;
}

Result<ltm::QueryResult> in_parts(const ltm::Query& query, server::MemoryClient& client) {
  ltm::QueryResult whole(query.is_ids_only());
  ENGRAM_RETURN_IF_ERROR(client.query_parts(query, [&whole](ltm::QueryResult part) {
    add_part(std::move(part), whole);
    return Status();
  }));
  return whole;
}

/// Asks a lived memory everywhere where it can be asked.
class Answering : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const ScratchDirectory scratch;
    const auto store = scratch / "store.engram";
    ASSERT_OK(make_lived_store(store));
    ask_server(store, scratch.path() / "s");
    ask_store(store);
    ask_for_latents(store, scratch.path() / "s");
  }

  static server::MemoryServer::Options options_of(const std::filesystem::path& store,
                                                  const std::filesystem::path& socket) {
    server::MemoryServer::Options options;
    options.service.name = "robot";
    options.service.store.emplace();
    options.service.store->store = store;
    options.service.store->recording.store.min_free_bytes = 0;
    options.rpc.endpoints = {*server::Endpoint::parse("unix:" + socket.string())};
    return options;
  }

  /// Half of today has left working memory, the rest is in it alone.
  static void ask_server(const std::filesystem::path& store, const std::filesystem::path& socket) {
    auto server = server::MemoryServer::start(options_of(store, socket), lived_models());
    ASSERT_OK(server);
    memory::MemoryService& service = (*server)->service();
    const auto today = commits_of_today();
    for (size_t i = 0; i < today.size(); ++i) {
      const bool is_stored = i < today.size() / 2;
      const auto admitted = service.commit(today[i], {},
                                           is_stored ? memory::MemoryService::Durability::kJournal
                                                     : memory::MemoryService::Durability::kMemory);
      ASSERT_OK(admitted);
      if (is_stored) ASSERT_OK(service.wait_stored(*admitted));
    }
    const std::string endpoint = (*server)->endpoints().front();
    const auto client = server::MemoryClient::connect(endpoint);
    ASSERT_OK(client);
    for (const std::string& question : questions()) {
      const auto query = ltm::Query::parse(question);
      ASSERT_TRUE(query.ok()) << question << ": " << query.status().to_string();
      auto answer = service.query(*query);
      served_[question] = text_of(
          answer.ok() ? Result<ltm::QueryResult>(std::move(*answer).to_result()) : answer.status(),
          "server 'robot'");
      wired_[question] = text_of((*client)->query(*query), "server 'robot'", endpoint);
      served_in_parts_[question] = text_of(
          in_parts(
              *query, [&](const ltm::Query& asked) { return service.begin_query(asked, {}); },
              [&](auto& cursor) { return service.next_part(cursor, 1); }),
          "server 'robot'");
      wired_in_parts_[question] = text_of(in_parts(*query, **client), "server 'robot'", endpoint);
    }
    for (const FutureQuestion& asked : future_questions()) {
      const ltm::MemoryId id = *ltm::MemoryId::parse(asked.entity);
      const ltm::PredictionRequest& request = asked.request;
      served_[asked.text()] = text_of(asked, service.predict(id, request), "server 'robot'");
      wired_[asked.text()] = text_of(
          asked,
          (*client)->predict(id, request.horizons, {request.from, request.plan, request.engine}),
          "server 'robot'", endpoint);
    }
    for (const EnginesQuestion& asked : engines_questions()) {
      const ltm::MemoryId id = *ltm::MemoryId::parse(asked.entity);
      served_[asked.text()] = text_of(service.engines(id, asked.ahead, asked.at), "server 'robot'");
      auto wired = (*client)->engines(id, std::array{asked.ahead}, asked.at);
      wired_[asked.text()] =
          text_of(wired.ok() ? Result<std::vector<ltm::EngineRecord>>(std::move(wired->front()))
                             : wired.status(),
                  "server 'robot'", endpoint);
    }
    ASSERT_OK((*server)->stop());
  }

  /// Asks a second server, which prefers latents, and the store in the same way.
  static void ask_for_latents(const std::filesystem::path& store,
                              const std::filesystem::path& socket) {
    auto options = options_of(store, socket);
    options.service.store->prefers_latents = true;
    auto server = server::MemoryServer::start(options, lived_models());
    ASSERT_OK(server);
    const std::string endpoint = (*server)->endpoints().front();
    const auto client = server::MemoryClient::connect(endpoint);
    ASSERT_OK(client);
    for (const std::string& question : latent_questions())
      wired_latents_[question] =
          text_of((*client)->query(*ltm::Query::parse(question)), "server 'robot'", endpoint);
    ASSERT_OK((*server)->stop());
    auto reader = ltm::StoreReader::open(store);
    ASSERT_OK(reader);
    ltm::Recall recall(*std::move(reader), lived_models());
    for (const std::string& question : latent_questions())
      stored_latents_[question] =
          text_of(recall.query(*ltm::Query::parse(question), {.prefer = ltm::Prefer::kLatent}),
                  "store '" + store.string() + "'");
  }

  static void ask_store(const std::filesystem::path& store) {
    auto reader = ltm::StoreReader::open(store);
    ASSERT_OK(reader);
    ltm::Recall recall(*std::move(reader), lived_models());
    const std::string place = "store '" + store.string() + "'";
    for (const std::string& question : questions()) {
      const ltm::Query query = *ltm::Query::parse(question);
      stored_[question] = text_of(recall.query(query), place);
      stored_in_parts_[question] =
          text_of(in_parts(
                      query, [&](const ltm::Query& asked) { return recall.begin(asked, {}); },
                      [&](auto& cursor) { return recall.next(cursor, 1); }),
                  place);
    }
    // In another order than the server was asked: what was asked before changes no answer.
    auto asked = future_questions();
    std::ranges::reverse(asked);
    for (const FutureQuestion& one : asked)
      stored_[one.text()] =
          text_of(one, recall.predict(*ltm::MemoryId::parse(one.entity), one.request, {}), place);
    for (const EnginesQuestion& one : engines_questions())
      stored_[one.text()] =
          text_of(recall.records(*ltm::MemoryId::parse(one.entity), one.at, one.ahead, {}), place);
  }

  static void expect_same(const Answers& found, const Answers& expected) {
    ASSERT_EQ(found.size(),
              questions().size() + future_questions().size() + engines_questions().size());
    for (const auto& [question, text] : expected)
      EXPECT_EQ(found.at(question), text) << "asked: " << question;
  }

  static const std::string& stored(const std::string& question) { return stored_.at(question); }

  static void expect_same_queries(const Answers& found) {
    ASSERT_EQ(found.size(), questions().size());
    for (const auto& [question, text] : found)
      EXPECT_EQ(text, stored(question)) << "asked: " << question;
  }

  static inline Answers served_, wired_, stored_, wired_latents_, stored_latents_;
  static inline Answers served_in_parts_, wired_in_parts_, stored_in_parts_;
};

TEST_F(Answering, AServerAndTheStoreThatItLeavesSayTheSame) {
  expect_same(served_, stored_);
}

TEST_F(Answering, TheWireChangesNothing) {
  expect_same(wired_, stored_);
}

TEST_F(Answering, PartsMakeTheSameAnswers) {
  expect_same_queries(stored_in_parts_);
  expect_same_queries(served_in_parts_);
  expect_same_queries(wired_in_parts_);
}

TEST_F(Answering, AServerThatPrefersLatentsSaysWhatTheStoreSays) {
  ASSERT_EQ(wired_latents_.size(), latent_questions().size());
  for (const auto& [question, text] : stored_latents_)
    EXPECT_EQ(wired_latents_.at(question), text) << "asked: " << question;
  // Snapshots in both forms are read from the other one.
  EXPECT_NE(stored_latents_.at("Vision/RGB/head/cam @ 25..35"),
            stored("Vision/RGB/head/cam @ 25..35"));
}

/// What can predict, and how well: what the equal answers are.
TEST_F(Answering, ListsEnginesOfAnyMoment) {
  const std::string& now = stored("engines of Vision/RGB/head/cam, 200ms ahead at now");
  EXPECT_NE(now.find("deep of '"), std::string::npos) << now;
  EXPECT_NE(now.find("copy-last of '"), std::string::npos) << now;
  EXPECT_NE(now,
            stored("engines of Vision/RGB/head/cam, 200ms ahead at 2020-09-13 12:26:44.000000"));
  EXPECT_NE(stored("engines of Nothing/like/that/exists, 200ms ahead at now").find("no entity"),
            std::string::npos);
}

/// Of the same moment, with a plan and without: what the equal answers are.
TEST_F(Answering, PredictsFromAMomentAndWithAPlan) {
  const auto told = [](const std::string& how) -> const std::string& {
    return stored("Vision/RGB/head/cam +1s from 2020-09-13 12:26:44.000000, " + how);
  };
  const std::string& planned = told("by '', plan Robot/State/arm/joints");
  EXPECT_NE(planned.find("by 'deep' horizon 1s plan 'Robot/State/arm/joints'"), std::string::npos)
      << planned;
  EXPECT_NE(planned.find("12:26:45.000000 predicted"), std::string::npos);
  // A plan has members, as any prediction has.
  EXPECT_NE(planned.find("'x' by 'deep' error"), std::string::npos) << planned;
  EXPECT_NE(planned, told("by 'deep', plan none"));
  EXPECT_NE(told("by 'copy-last', plan Robot/State/arm/joints").find("starts from no other entity"),
            std::string::npos);
  EXPECT_NE(told("by 'oracle', plan none").find("nothing named 'oracle'"), std::string::npos);
  EXPECT_NE(told("by '', plan Nothing/like/that/exists").find("no entity 'Nothing/"),
            std::string::npos);
}

/// What the equal answers are, so that all being wrong in the same way is found too.
TEST_F(Answering, SaysWhatAUserExpects) {
  EXPECT_NE(stored("Vision/RGB/head/cam @ 0..4").find("reconstructed model"), std::string::npos);
  EXPECT_NE(stored("Vision/RGB/head/cam @ latest").find(" recorded model ''"), std::string::npos);
  // Far horizons: one limit for all, in time.
  EXPECT_NE(stored("Vision/RGB/head/cam @ +1min").find("horizon 1min"), std::string::npos);
  EXPECT_NE(stored("Vision/RGB/head/cam @ +61s").find("needs at most 1min"), std::string::npos);
  // A damaged old snapshot costs no prediction; asked for itself, it is an error.
  EXPECT_NE(stored("Vision/RGB/head/damaged @ +200ms").find(" predicted "), std::string::npos);
  EXPECT_NE(stored("Vision/RGB/head/damaged @ 0..4").find("a code is no value"), std::string::npos);
  // A condition that cannot be read is not known.
  EXPECT_NE(stored("Vision/RGB/head/led @ +200ms").find(" predicted "), std::string::npos);
  const std::string& remembered =
      stored("Robot/State/arm/forgotten @ 2020-09-13 12:26:41.000000..2020-09-13 12:26:45.000000");
  EXPECT_NE(remembered.find("12:26:41.800000 recorded"), std::string::npos);
  EXPECT_EQ(remembered.find("12:26:42.600000"), std::string::npos);
  EXPECT_NE(remembered.find("12:26:44.000000 recorded"), std::string::npos);
  EXPECT_NE(stored("Nothing/like/that/exists @ all").find("no entity matches"), std::string::npos);
  EXPECT_NE(stored("?ids Robot/State/arm/joints @ +200ms").find("    #1 "), std::string::npos);
}

}  // namespace
}  // namespace engram
