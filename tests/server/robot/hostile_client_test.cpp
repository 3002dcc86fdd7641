// SPDX-License-Identifier: Apache-2.0
// Clients that mean harm: each time another one is served all along, and counters say what was
// refused.
#include <engram/v1/memory.grpc.pb.h>
#include <gmock/gmock.h>

#include <atomic>
#include <random>
#include <thread>

#include "ltm/idf/binary.h"
#include "tests/server/robot/hostile_client.h"

namespace engram::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::frame;
using testing::HostileClient;
using testing::kCommits;
using testing::kMiB;
using testing::kPreface;
using testing::kQueries;
using testing::kSubscriptions;
using testing::random_bytes;
using testing::raw;
using testing::RawSocket;
using testing::RawStreams;
using testing::resident_bytes;
using testing::RunningServer;

TEST_F(HostileClient, SaysGarbage) {
  start();
  std::mt19937 random(1);
  for (int i = 0; i < 40; ++i) {
    RawSocket socket(socket_path());
    if (i % 2 == 0) socket.say(kPreface);
    socket.say(random_bytes(random, 1 << 14));
  }
}

TEST_F(HostileClient, SaysHalfOfAFrame) {
  start();
  std::vector<std::unique_ptr<RawSocket>> open;
  for (size_t length = 0; length < 60; ++length) {
    const std::string all = kPreface + frame(4, 0, 0, "") + frame(1, 0, 1, std::string(40, '\x82'));
    open.push_back(std::make_unique<RawSocket>(socket_path()));
    open.back()->say(all.substr(0, length));
  }
  expect_served();
}

/// gRPC before 1.53 keeps all of them until they end (CVE-2023-33953).
TEST_F(HostileClient, SendsEndlessHeaders) {
  running.options.rpc.max_message_bytes = 16 << 20;
  start();
  const size_t before = resident_bytes();
  // A short literal header again and again, in frames that go on and on.
  std::string fields;
  while (fields.size() < 16'000)
    fields += std::string(
                  "\x00\x08"
                  "abcdefgh"
                  "\x64",
                  11) +
              std::string(100, 'v');
  for (int round = 0; round < 2; ++round) {
    RawSocket socket(socket_path());
    socket.say(kPreface + frame(4, 0, 0, ""));
    bool goes_on = socket.say(frame(1, 0, 1, fields));
    size_t sent = 0, highest = 0;
    for (; goes_on && sent < size_t{1} << 30; sent += fields.size()) {
      goes_on = socket.say(frame(9, 0, 1, fields), 10);
      if (sent % (fields.size() << 8) == 0) highest = std::max(highest, resident_bytes());
    }
    // Mostly the connection is cut after some 200 MB. On a busy machine the quota of memory may
    // take back the stream alone; the rest of its headers is then read and dropped.
    // Unbounded it would be two gigabytes.
    EXPECT_LT(highest, before + 700 * kMiB) << round;
    expect_served();
  }
  const auto until = steady_now() + seconds(30);
  while (resident_bytes() > before + 150 * kMiB && steady_now() < until)
    std::this_thread::sleep_for(milliseconds(200));
  EXPECT_LE(resident_bytes(), before + 150 * kMiB) << "is not given back";
}

/// Says that it opens `streams` streams and resets each at once; false where it was hung up on. A
/// server that is busy with the flood before may read nothing for seconds, which is no end of it.
bool flood(RawSocket& socket, uint32_t streams) {
  constexpr uint32_t kAtOnce = 500;
  constexpr int kPatience = 60;  // Seconds.
  // A call that a server takes: POST, http, path, authority, content type and te.
  const std::string call = std::string("\x83\x86\x44\x06/a/b/c\x41\x01") + "a\x5f\x10" +
                           "application/grpc\x40\x02" + "te\x08" + "trailers";
  bool goes_on = socket.say(kPreface + frame(4, 0, 0, ""));
  for (uint32_t done = 0; goes_on && done < streams; done += kAtOnce) {
    std::string resets;
    for (uint32_t i = 0; i < kAtOnce; ++i) {
      const uint32_t stream = 2 * (done + i) + 1;
      resets += frame(1, 4, stream, call);
      resets += frame(3, 0, stream, std::string("\0\0\0\x08", 4));
    }
    goes_on = socket.say(resets, kPatience);
  }
  return goes_on;
}

TEST_F(HostileClient, OpensAndForgetsStreamsAtOnce) {
  start();
  RawSocket socket(socket_path());
  flood(socket, 10'000);
}

TEST_F(HostileClient, FloodsAPortWithStreams) {
  running.options.rpc.endpoints.push_back(*Endpoint::parse("127.0.0.1:0"));
  start();
  const int port = Endpoint::parse(running.server->endpoints().back())->port();
  const size_t before = resident_bytes();
  for (int round = 0; round < 3; ++round) {
    RawSocket socket(port);
    EXPECT_FALSE(flood(socket, 120'000)) << round;
    expect_served();
  }
  // One is counted just after it was shut down.
  EXPECT_TRUE(reaches("engram_connections_cut", 3));
  EXPECT_EQ(metric("engram_connections_cut"), 3);
  // It would be gigabytes.
  EXPECT_LT(resident_bytes(), before + 300 * kMiB);
}

TEST_F(HostileClient, MayCallAsOftenAsItLikes) {
  start();
  const auto busy = running.client();
  const auto until = std::chrono::steady_clock::now() + seconds(3);
  int calls = 0;
  for (; std::chrono::steady_clock::now() < until; ++calls) ASSERT_OK(busy->metrics());
  EXPECT_GT(calls, 1000) << "more than may stay without an end";
  EXPECT_EQ(metric("engram_connections_cut"), 0);
}

TEST_F(HostileClient, FloodsASocketWithStreams) {
  start();
  const size_t before = resident_bytes();
  for (int round = 0; round < 2; ++round) {
    RawSocket socket(socket_path());
    EXPECT_FALSE(flood(socket, 120'000)) << round;
    expect_served();
  }
  EXPECT_TRUE(reaches("engram_connections_cut", 2));
  EXPECT_LT(resident_bytes(), before + 300 * kMiB);
}

TEST_F(HostileClient, SendsMessagesThatAreTooLarge) {
  start();
  const auto hostile = running.client({.shares_memory = false});
  const idf::Data large = std::string(size_t{80} << 20, 'x');
  const Status status = hostile->commit(RunningServer::commit("Bad/b/c/d", 1, large));
  EXPECT_EQ(status.code(), StatusCode::kResourceExhausted) << status.to_string();
  EXPECT_OK(hostile->commit(RunningServer::commit("Bad/b/c/d", 2)));  // On another stream.
}

TEST_F(HostileClient, WritesWhatIsTooLargeForSharedMemory) {
  start();
  const auto hostile = running.client();
  const idf::Data large = std::string(size_t{80} << 20, 'x');
  EXPECT_OK(hostile->commit(RunningServer::commit("Bad/b/c/d", 1, large)));
  const idf::Data larger = std::string(size_t{300} << 20, 'x');
  const Status status = hostile->commit(RunningServer::commit("Bad/b/c/d", 2, larger));
  EXPECT_EQ(status.code(), StatusCode::kResourceExhausted) << status.to_string();
  EXPECT_OK(hostile->commit(RunningServer::commit("Bad/b/c/d", 3)));
}

TEST_F(HostileClient, SendsWhatIsNoMessage) {
  start();
  std::mt19937 random(2);
  RawStreams streams;
  const auto on = channel();
  int count = 0;
  for (const char* method : {kCommits, kQueries, kSubscriptions})
    for (int i = 0; i < 10; ++i, ++count)
      EXPECT_OK(streams.open(on, method).send(raw("\xff\xff" + random_bytes(random, 1000))));
  EXPECT_TRUE(RawStreams::reaches(streams.ended, count));
  EXPECT_EQ(streams.refused, count);
  EXPECT_EQ(metric("engram_requests_broken_total"), count);
}

TEST_F(HostileClient, SendsCommitsThatCannotBe) {
  start();
  std::mt19937 random(3);
  RawStreams streams;
  ClientStream& commits = streams.open(channel(), kCommits);
  idf::Data deep = int64_t{1};
  for (int i = 0; i < 20; ++i) deep = idf::List{std::move(deep)};
  const auto good = *idf::encode(deep);
  constexpr int kCount = 2000;
  for (int i = 0; i < kCount; ++i) {
    v1::CommitRequest request;
    v1::Snapshot& update = *request.add_updates();
    update.set_entity(i % 50 == 0 ? std::string(size_t{1} << 16, '/') : "Bad/b/c/d");
    update.set_time_ns(static_cast<int64_t>(random()) << 31);
    std::string data(as_text(std::span(good)));
    for (int k = 0; k < 1 + i % 8; ++k) data[random() % data.size()] = static_cast<char>(random());
    if (i % 7 == 0) data += data;
    if (i % 11 == 0) update.add_instances()->mutable_shared()->set_size(random());
    if (i % 13 == 0) update.mutable_block()->set_slab(random());
    update.add_instances()->set_data(data);
    request.set_lease_bytes(i % 17 == 0 ? UINT64_MAX : 0);
    request.set_durability(static_cast<v1::Durability>(random() % 5));
    EXPECT_OK(commits.send(to_bytes(request)));
  }
  EXPECT_TRUE(RawStreams::reaches(streams.replies, kCount)) << streams.replies;
  EXPECT_GT(metric("engram_commits_refused_total"), kCount / 2);
}

TEST_F(HostileClient, NestsAsDeepAsItCan) {
  start();
  RawStreams streams;
  ClientStream& commits = streams.open(channel(), kCommits);
  // The form of a list of one, again and again: that of two lists, without that of one.
  const auto one = *idf::encode(idf::List{int64_t{1}});
  const auto two = *idf::encode(idf::List{idf::List{int64_t{1}}});
  const std::string inner(as_text(std::span(one)));
  const std::string prefix =
      std::string(as_text(std::span(two))).substr(0, two.size() - one.size());
  std::string deep;
  for (int i = 0; i < 1'000'000; ++i) deep += prefix;
  v1::CommitRequest request;
  request.add_updates()->set_entity("Bad/b/c/d");
  request.mutable_updates(0)->add_instances()->set_data(deep + inner);
  EXPECT_OK(commits.send(to_bytes(request)));
  EXPECT_TRUE(RawStreams::reaches(streams.replies, 1));
  EXPECT_EQ(metric("engram_commits_refused_total"), 1);
}

/// Asks again and again for what is large, and never reads an answer.
TEST_F(HostileClient, NeverReadsItsAnswers) {
  start();
  const idf::Data large = std::string(size_t{2} << 20, 'x');
  ASSERT_OK(running.client()->commit(RunningServer::commit("Bad/b/c/d", 1, large)));
  const auto stub = v1::MemoryServer::NewStub(channel());
  const size_t before = resident_bytes();
  for (const char* engine : {"", "copy-last"}) {
    grpc::ClientContext context;
    const auto stream = stub->Query(&context);
    std::atomic<int> written{0};
    std::jthread asks([&] {
      v1::QueryRequest request;
      request.set_query("Bad/b/c/d");
      request.set_engine(engine);
      while (written < 100'000 && stream->Write(request)) ++written;
    });
    std::this_thread::sleep_for(seconds(1));
    expect_served();
    // A thousand answers would be two gigabytes.
    EXPECT_LT(resident_bytes(), before + 300 * kMiB);
    context.TryCancel();
    asks.join();
    EXPECT_GT(written, 10);
  }
}

TEST_F(HostileClient, SubscribesAndNeverReads) {
  running.options.service.memory.all.bytes = size_t{8} << 20;
  start();
  const auto stub = v1::MemoryServer::NewStub(channel());
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
  std::vector<std::unique_ptr<grpc::ClientReaderWriter<v1::SubscribeRequest, v1::Notification>>>
      all;
  for (int i = 0; i < 20; ++i) {
    contexts.push_back(std::make_unique<grpc::ClientContext>());
    all.push_back(stub->Subscribe(contexts.back().get()));
    v1::SubscribeRequest request;
    request.set_with_data(true);
    request.set_queue_bytes(size_t{8} << 20);
    ASSERT_TRUE(all.back()->Write(request));
  }
  std::this_thread::sleep_for(milliseconds(300));
  const size_t before = resident_bytes();
  const auto writer = running.client();
  const idf::Data large = std::string(size_t{1} << 20, 'x');
  for (int64_t at = 1; at <= 100; ++at)
    ASSERT_OK(writer->commit(RunningServer::commit("Bad/b/c/d", at, large)));
  EXPECT_GT(metric("engram_events_lost_total"), 20 * 50);
  EXPECT_LT(resident_bytes(), before + 500 * kMiB);
  for (const auto& context : contexts) context->TryCancel();
}

TEST_F(HostileClient, OpensThousandsOfStreams) {
  good_token = std::string(40, 'g');
  write_tokens("");
  start();
  RawStreams streams;
  std::vector<std::shared_ptr<grpc::Channel>> channels;
  constexpr int kStreams = 2000;
  for (int i = 0; i < kStreams; ++i) {
    if (i % 200 == 0) channels.push_back(channel());
    (void)streams.open(channels.back(), kSubscriptions, bad_token)
        .send(to_bytes(v1::SubscribeRequest()));
  }
  EXPECT_TRUE(RawStreams::reaches(streams.exhausted, kStreams - 1024)) << streams.exhausted;
  EXPECT_TRUE(RawStreams::reaches(streams.replies, 1024)) << streams.replies;
  EXPECT_EQ(metric("engram_streams_refused_total"), kStreams - 1024);
  expect_served();
}

TEST_F(HostileClient, HasNoTokenOrAWrongOne) {
  good_token = std::string(40, 'g');
  write_tokens("");
  start();
  for (const std::string& token :
       {std::string(), std::string("wrong"), std::string(100'000, 'x')}) {
    const auto hostile = running.client({.token = token, .timeout = milliseconds(500)});
    EXPECT_FALSE(hostile->commit(RunningServer::commit("Good/b/c/d", -1)).ok());
    EXPECT_FALSE(hostile->query(*ltm::Query::parse("Good @ all")).ok());
    EXPECT_FALSE(hostile->info().ok());
    EXPECT_FALSE(hostile->declare(*ltm::MemoryId::parse("Good/b"), idf::Type::int64()).ok());
  }
  EXPECT_GE(metric("engram_streams_refused_total"), 4);
  EXPECT_GE(metric("engram_calls_refused_total"), 4);
  const auto foreign = running.client({.token = bad_token});
  EXPECT_FAILS(foreign->commit(RunningServer::commit("Good/b/c/d", -1)),
               StatusCode::kFailedPrecondition, "bad");
  EXPECT_OK(foreign->commit(RunningServer::commit("Bad/b/c/d", 1)));
  const auto seen = foreign->query(*ltm::Query::parse(".* @ all"));
  ASSERT_OK(seen);
  EXPECT_FALSE(seen->contains(*ltm::MemoryId::parse("Good")));
  // It is told no prediction of what it may not read, and none that a plan tells of.
  const auto good = *ltm::MemoryId::parse("Good/b/c/d"), bad = *ltm::MemoryId::parse("Bad/b/c/d");
  const std::vector<Duration> ahead{seconds(1)}, none, many(1025, seconds(1));
  const PredictOptions from{.at = time_from_ns(1)};
  EXPECT_FAILS(foreign->predict(good, ahead, from), StatusCode::kFailedPrecondition,
               "may not ask for predictions of 'Good");
  EXPECT_FAILS(foreign->predict(bad, ahead, {.plan = good}), StatusCode::kFailedPrecondition,
               "may not read 'Good");
  EXPECT_OK(foreign->predict(bad, ahead, from));
  EXPECT_FAILS(foreign->predict(bad, none, from), StatusCode::kInvalidArgument, "no horizon");
  EXPECT_FAILS(foreign->predict(bad, many, from), StatusCode::kInvalidArgument, "at most 1024");
}

TEST_F(HostileClient, AsksMoreOftenThanItMay) {
  good_token = std::string(40, 'g');
  write_tokens("    rate: 20Hz\n");
  start();
  const auto hostile = running.client({.token = bad_token});
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    const StatusCode commit = hostile->commit(RunningServer::commit("Bad/b/c/d", i)).code();
    const StatusCode query = hostile->query(*ltm::Query::parse("Bad")).status().code();
    const StatusCode info = hostile->info().status().code();
    for (const StatusCode code : {commit, query, info})
      if (code == StatusCode::kResourceExhausted) ++refused;
  }
  EXPECT_GT(refused, 500);
  EXPECT_EQ(metric("engram_requests_over_rate_total"), refused);
}

}  // namespace
}  // namespace engram::server
