// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/names_rpc.h"

#include <engram/v1/names.grpc.pb.h>
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>

#include <thread>

#include "tests/ltm/expect_status.h"
#include "tests/server/access/secret_file.h"
#include "tests/server/robot/running_names.h"

namespace engram::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::IsEmpty;
using testing::RunningNames;
using ::testing::SizeIs;

Registration registration(const std::string& server, std::vector<std::string> memories,
                          uint64_t incarnation = 1) {
  return {server, std::move(memories), {"unix:/run/" + server}, incarnation};
}

TEST(NamesRpc, TellsWhoHasWhat) {
  RunningNames names;
  names.start();
  const auto client = names.client();
  const auto interval = client->add(registration("one", {"A", "B"}));
  ASSERT_OK(interval);
  EXPECT_EQ(*interval, names.options.heartbeat_interval);
  ASSERT_OK(client->add(registration("two", {"C"})));
  ASSERT_OK(client->add(registration("any", {})));
  const auto found = client->resolve("B");
  ASSERT_OK(found);
  ASSERT_THAT(*found, SizeIs(1));
  EXPECT_EQ((*found)[0], registration("one", {"A", "B"}));
  EXPECT_THAT(*client->resolve("[AC]"), SizeIs(2));
  EXPECT_THAT(*client->resolve(""), SizeIs(3)) << "those without named memories too";
  EXPECT_THAT(*client->resolve("X"), IsEmpty());
  EXPECT_EQ(client->resolve("(").status().code(), StatusCode::kInvalidArgument);
}

TEST(NamesRpc, RefusesWhatAnotherServerHas) {
  RunningNames names;
  names.start();
  const auto client = names.client();
  ASSERT_OK(client->add(registration("one", {"A"})));
  EXPECT_FAILS(client->add(registration("two", {"B", "A"})), StatusCode::kAlreadyExists, "one");
  EXPECT_THAT(*client->resolve("B"), IsEmpty()) << "nothing changes then";
  EXPECT_EQ(client->heartbeat("one", 9).code(), StatusCode::kFailedPrecondition);
  EXPECT_EQ(client->heartbeat("two", 1).code(), StatusCode::kNotFound);
  ASSERT_OK(client->heartbeat("one", 1));
  ASSERT_OK(client->remove("one", 1));
  ASSERT_OK(client->add(registration("two", {"B", "A"})));
}

TEST(NamesRpc, LetsGoOfServersWithoutAHeartbeat) {
  RunningNames names;
  names.options.heartbeat_interval = milliseconds(30);
  names.start();
  const auto client = names.client();
  ASSERT_OK(client->add(registration("one", {"A"})));
  for (int i = 0; i < 200 && !client->resolve("A").value_or({}).empty(); ++i)
    std::this_thread::sleep_for(milliseconds(20));
  EXPECT_THAT(*client->resolve("A"), IsEmpty());
}

TEST(NamesRpc, AnswersThoseWhoWaitWhenTheMemoryComes) {
  RunningNames names;
  names.start();
  const auto client = names.client();
  std::jthread later([&client] {
    std::this_thread::sleep_for(milliseconds(200));
    EXPECT_OK(client->add(registration("one", {"A"})));
  });
  const auto found = client->resolve("A", seconds(10));
  ASSERT_OK(found);
  EXPECT_THAT(*found, SizeIs(1));
  EXPECT_THAT(*client->resolve("B", milliseconds(50)), IsEmpty()) << "after its wait";
}

TEST(NamesRpc, EndsWhileClientsWait) {
  RunningNames names;
  names.start();
  const auto client = names.client();
  std::jthread waits([&client] { EXPECT_FALSE(client->resolve("A", seconds(60)).ok()); });
  std::this_thread::sleep_for(milliseconds(100));
  names.stop();
}

TEST(NamesRpc, TellsWatchersOfWhatChanges) {
  RunningNames names;
  names.start();
  const auto client = names.client();
  ASSERT_OK(client->add(registration("one", {"A"})));
  const auto stub = v1::MemoryNameSystem::NewStub(
      grpc::CreateChannel(names.endpoint(), grpc::InsecureChannelCredentials()));
  grpc::ClientContext context;
  const auto watch = stub->Watch(&context, v1::WatchRequest());
  v1::NameChanges changes;
  ASSERT_TRUE(watch->Read(&changes));
  EXPECT_TRUE(changes.is_everything());
  ASSERT_EQ(changes.servers_size(), 1);
  EXPECT_EQ(to_registration(changes.servers(0)), registration("one", {"A"}));
  ASSERT_OK(client->add(registration("two", {"B"})));
  ASSERT_TRUE(watch->Read(&changes));
  ASSERT_EQ(changes.events_size(), 1);
  EXPECT_EQ(changes.events(0).kind(), v1::NameEvent::ARRIVED);
  ASSERT_OK(client->remove("two", 1));
  ASSERT_TRUE(watch->Read(&changes));
  EXPECT_EQ(changes.events(0).kind(), v1::NameEvent::UNREGISTERED);
  names.stop();
  EXPECT_FALSE(watch->Read(&changes));
  EXPECT_FALSE(watch->Finish().ok());
}

TEST(NamesRpc, LetsGoOfWatchersThatAreGone) {
  RunningNames names;
  names.start();
  const auto client = names.client();
  for (int i = 0; i < 50; ++i) {
    const auto stub = v1::MemoryNameSystem::NewStub(
        grpc::CreateChannel(names.endpoint(), grpc::InsecureChannelCredentials()));
    grpc::ClientContext context;
    const auto watch = stub->Watch(&context, v1::WatchRequest());
    v1::NameChanges changes;
    ASSERT_TRUE(watch->Read(&changes));
    context.TryCancel();
    ASSERT_OK(client->add(registration("one", {"A"}, static_cast<uint64_t>(i) + 1)));
  }
}

TEST(NamesRpc, KeepsClientsThatAskWhetherItIsThere) {
  RunningNames names;
  names.start();
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 1100);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  const auto channel =
      grpc::CreateCustomChannel(names.endpoint(), grpc::InsecureChannelCredentials(), arguments);
  ASSERT_TRUE(channel->WaitForConnected(std::chrono::system_clock::now() + seconds(5)));
  const auto state = GRPC_CHANNEL_READY;
  EXPECT_FALSE(channel->WaitForStateChange(state, std::chrono::system_clock::now() + seconds(7)))
      << "sent away";
}

TEST(NamesRpc, LetsOnlyThoseSpeakForAServerWhoMayWriteItsMemories) {
  RunningNames names;
  const std::string reader(40, 'r');
  const std::string writer(40, 'w');
  const auto file = names.folder / "tokens.yaml";
  testing::write_secret(
      file,
      fmt::format("tokens:\n"
                  "  - name: reader\n    token_sha256: {}\n    role: read\n    memories: all\n"
                  "  - name: writer\n    token_sha256: {}\n    role: write\n    memories: all\n",
                  to_hex(hash_token(reader)), to_hex(hash_token(writer))));
  auto access = AccessPolicy::read_file(file);
  ASSERT_OK(access);
  names.access = *std::move(access);
  names.start();
  const auto may_write = names.client({.token = writer});
  const auto may_read = names.client({.token = reader});
  ASSERT_OK(may_write->add(registration("one", {"A"})));
  EXPECT_FALSE(may_read->add(registration("two", {"B"})).ok());
  EXPECT_FALSE(may_read->remove("one", 1).ok());
  EXPECT_FALSE(may_read->heartbeat("one", 1).ok());
  EXPECT_FALSE(names.client()->resolve("A").ok()) << "without a token";
  EXPECT_THAT(*may_read->resolve("A"), SizeIs(1));
  ASSERT_OK(may_write->heartbeat("one", 1));
  ASSERT_OK(may_write->remove("one", 1));
}

}  // namespace
}  // namespace engram::server
