// SPDX-License-Identifier: Apache-2.0
// Providers that write anything into their rings.
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>

#include <future>
#include <random>
#include <thread>

#include "server/client/calls.h"
#include "server/client/shared_lane.h"
#include "server/sharing/sensory_writer.h"
#include "server/wire/wire_snapshot.h"
#include "tests/ltm/expect_status.h"
#include "tests/server/robot/running_server.h"
#include "tests/server/robot/sensory_images.h"

namespace engram::server {
namespace {

using namespace std::chrono_literals;
using testing::image_commit;
using testing::kLeft;
using testing::kRight;
using testing::RunningServer;

/// A client that holds the memory of a ring in its hands.
class SensoryHostile : public ::testing::Test {
 protected:
  void SetUp() override {
    // The library that reads messages says of each text what is wrong with it.
    ::testing::internal::CaptureStderr();
    auto& sensory = running_.options.service.sensory;
    sensory.segments = {{*ltm::MemoryId::parse("Vision/RGB"), 10s},
                        {*ltm::MemoryId::parse("Vision/Depth"), 10s}};
    sensory.ring_bytes = size_t{1} << 20;
    running_.start();
    channel_ = grpc::CreateChannel(running_.endpoint(), grpc::InsecureChannelCredentials());
    stub_ = v1::MemoryServer::NewStub(channel_);
    lane_ = SharedLane::open(*stub_, {});
    ASSERT_NE(lane_, nullptr);
    calls_ = std::make_shared<Calls<v1::CommitReply>>(channel_, "/engram.v1.MemoryServer/Commit",
                                                      "", lane_->session());
  }

  void TearDown() override {
    EXPECT_EQ(::testing::internal::GetCapturedStderr().find("runtime error"), std::string::npos);
    // Whatever it did, others are served.
    ASSERT_OK(running_.client()->commit(RunningServer::commit("Robot/a/b/c", 1)));
    EXPECT_OK(running_.client()->query(*ltm::Query::parse("Robot @ latest")));
    if (calls_) calls_->close();
  }

  Result<v1::CommitReply> ask(v1::CommitRequest request) {
    auto promise = std::make_shared<std::promise<Result<v1::CommitReply>>>();
    auto future = promise->get_future();
    calls_->call(
        [&request](uint64_t number) {
          request.set_number(number);
          return to_bytes(request);
        },
        {[promise](v1::CommitReply& reply) {
           const Status status = to_status(reply.outcome());
           promise->set_value(status.ok() ? Result<v1::CommitReply>(reply) : status);
           return true;
         },
         [promise](const Status& status) { promise->set_value(status); }});
    if (future.wait_for(10s) != std::future_status::ready) return unavailable("no answer");
    return future.get();
  }

  Result<v1::CommitReply> open(const std::vector<std::string>& entities) {
    v1::CommitRequest request;
    for (const std::string& entity : entities) request.add_sensory_entities(entity);
    return ask(std::move(request));
  }

  Status tell(uint64_t ring, uint64_t written) {
    v1::CommitRequest request;
    request.mutable_entry()->set_ring(ring);
    request.mutable_entry()->set_written(written);
    return ask(std::move(request)).status();
  }

  /// Opens a ring for the left camera and maps it.
  void open_ring() {
    const auto reply = open({kLeft});
    ASSERT_OK(reply);
    ring_ = reply->ring();
    auto kept = lane_->memory().keep_writable(to_block(ring_.entries()));
    ASSERT_OK(kept);
    memory_ = *kept;
    ASSERT_OK(tell(ring_.id(), 0));
    // It may say so again.
    ASSERT_OK(tell(ring_.id(), 0));
  }

  std::span<uint64_t> words() {
    return {reinterpret_cast<uint64_t*>(memory_.bytes.data()), memory_.bytes.size() / 8};
  }

  /// Writes an entry as its own head and data are, and tells the server.
  Status write(SensoryRingWriter& writer, const v1::CommitRequest& head, size_t data_bytes) {
    const std::string text = head.SerializeAsString();
    return write(writer, text, data_bytes);
  }
  Status write(SensoryRingWriter& writer, const std::string& head, size_t data_bytes) {
    ENGRAM_ASSIGN_OR_RETURN(auto room,
                            writer.reserve(head.size(), data_bytes, steady_now(), [] {}));
    std::ranges::copy(as_bytes(head), room.head.begin());
    return tell(ring_.id(), writer.publish(1, time_from_ns(1), steady_now()) + 1);
  }

  static v1::CommitRequest head_of(const std::string& entity, uint64_t offset, uint64_t size,
                                   int instances = 1) {
    v1::CommitRequest head;
    v1::Snapshot& update = *head.add_updates();
    update.set_entity(entity);
    update.set_time_ns(1);
    for (int i = 0; i < instances; ++i) {
      v1::Span& span = *update.add_instances()->mutable_shared();
      span.set_offset(offset);
      span.set_size(size);
    }
    return head;
  }

  memory::SensoryCounts counts() { return *running_.server->service().counters().sensory; }

  RunningServer running_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::MemoryServer::Stub> stub_;
  std::shared_ptr<SharedLane> lane_;
  std::shared_ptr<Calls<v1::CommitReply>> calls_;
  v1::SensoryRing ring_;
  SharingClient::KeptBlock memory_;
};

TEST_F(SensoryHostile, AsksForWhatThereIsNot) {
  EXPECT_FAILS(open({"Robot/a/b/c"}).status(), StatusCode::kFailedPrecondition, "Robot/a/b/c");
  EXPECT_FAILS(open({kLeft, "Vision/Depth/a/b"}).status(), StatusCode::kFailedPrecondition,
               "one sensory segment");
  EXPECT_FAILS(open({"Vision/RGB"}).status(), StatusCode::kInvalidArgument, "Vision/RGB");
  EXPECT_FAILS(tell(7, 1), StatusCode::kNotFound, "sensory ring 7");
  const auto reply = open({kLeft});
  ASSERT_OK(reply);
  EXPECT_FAILS(tell(reply->ring().id(), 1), StatusCode::kFailedPrecondition, "has not begun");
  EXPECT_FALSE(tell(reply->ring().id(), 0).ok()) << "it has mapped nothing";
  for (int i = 1; i < 63; ++i) ASSERT_OK(open({fmt::format("Vision/RGB/head/{}", i)}));
  // The place of the one that fits is not lost.
  for (int i = 0; i < 2; ++i)
    EXPECT_FAILS(open({fmt::format("Vision/RGB/more/{}", i), "Vision/RGB/more/last"}).status(),
                 StatusCode::kResourceExhausted, "63 entities");
  ASSERT_OK(open({"Vision/RGB/head/63"}));
  EXPECT_FAILS(open({"Vision/RGB/head/more"}).status(), StatusCode::kResourceExhausted,
               "64 entities");
}

TEST_F(SensoryHostile, WritesGarbageIntoItsRing) {
  open_ring();
  const auto attention = running_.server->service().attend("Vision");
  ASSERT_OK(attention);
  std::mt19937_64 random(1);
  const SensoryLayout layout(memory_.bytes.size());
  for (int round = 0; round < 300; ++round) {
    const size_t head_words = layout.data_begin() / 8 + 1000;
    for (size_t i = 0; i < head_words; ++i) words()[i] = random() >> (random() % 64);
    // Half of the slots name themselves, and places that lie in the ring.
    for (uint64_t slot = 0; slot < layout.slots(); slot += 2) {
      uint64_t* said = &words()[layout.slot_of(slot) / 8];
      const uint64_t sizes[] = {slot,
                                random(),
                                static_cast<uint64_t>(steady_now().time_since_epoch().count()),
                                layout.data_begin() + random() % layout.data_bytes(),
                                random() % 4096,
                                random() % layout.data_bytes()};
      std::ranges::copy(sizes, said);
    }
    words()[0] = random() % 2 == 0 ? 0 : random();
    words()[1] = 300 + static_cast<uint64_t>(round);
    const Status told = tell(ring_.id(), words()[1]);
    ASSERT_NE(told.code(), StatusCode::kUnavailable) << told.to_string();
  }
  EXPECT_GT(counts().refused, 0u);
  EXPECT_EQ(running_.server->service().counters().memory.committed, 0u);
}

TEST_F(SensoryHostile, SaysWhatAnEntryDoesNotHave) {
  open_ring();
  const auto attention = running_.server->service().attend("Vision");
  ASSERT_OK(attention);
  SensoryControl control;
  SensoryRingWriter writer(memory_.bytes, control, 10s);
  EXPECT_FAILS(write(writer, std::string(10, '\xff'), 10), StatusCode::kDataLoss, "no message");
  EXPECT_FAILS(write(writer, head_of(kLeft, 0, 11), 10), StatusCode::kDataLoss,
               "11 bytes at 0 of an entry's data, which have 10");
  EXPECT_FAILS(write(writer, head_of(kLeft, UINT64_MAX, 2), 10), StatusCode::kDataLoss,
               "an entry's data");
  // Others' entities: those of other segments, and those that it did not ask for.
  EXPECT_FAILS(write(writer, head_of("Robot/a/b/c", 0, 2), 10), StatusCode::kDataLoss,
               "found 0 snapshots");
  EXPECT_FAILS(write(writer, head_of(kRight, 0, 2), 10), StatusCode::kDataLoss,
               "found 0 snapshots");
  v1::CommitRequest twice = head_of(kLeft, 0, 2);
  *twice.add_updates() = twice.updates(0);
  EXPECT_FAILS(write(writer, twice, 10), StatusCode::kDataLoss, "found 2 snapshots");
  // The same bytes over and over would take any amount of RAM.
  EXPECT_FAILS(write(writer, head_of(kLeft, 0, 500'000, 1000), 500'000), StatusCode::kDataLoss,
               "an entry's data");
  v1::CommitRequest inlined = head_of(kLeft, 0, 2);
  inlined.mutable_updates(0)->mutable_instances(0)->set_data("ab");
  EXPECT_FALSE(write(writer, inlined, 10).ok());
  EXPECT_EQ(running_.server->service().counters().memory.committed, 0u);
  EXPECT_EQ(counts().passed, 0u);
  EXPECT_EQ(counts().refused, 8u);
  EXPECT_EQ(counts().lost(), 0u);
}

TEST_F(SensoryHostile, SaysMoreThanTheServerReads) {
  open_ring();
  const auto attention = running_.server->service().attend("Vision");
  ASSERT_OK(attention);
  SensoryControl control;
  SensoryRingWriter writer(memory_.bytes, control, 10s);
  EXPECT_FAILS(write(writer, std::string(900'000, '\xff'), 0), StatusCode::kDataLoss, "no message");
  EXPECT_EQ(counts().refused, 1u);
}

TEST_F(SensoryHostile, AsksForWhatPassedNeither) {
  open_ring();
  SensoryControl control;
  SensoryRingWriter writer(memory_.bytes, control, 10s);
  const auto put = [&](SteadyTime came) {
    const std::string head = head_of(kLeft, 0, 2).SerializeAsString();
    auto room = writer.reserve(head.size(), 300'000, came, [] {});
    EXPECT_OK(room);
    std::ranges::copy(as_bytes(head), room->head.begin());
    return writer.publish(1, time_from_ns(1), came) + 1;
  };
  const uint64_t old = put(steady_now() - 20s);
  const uint64_t gone = put(steady_now());
  for (int i = 0; i < 4; ++i) put(steady_now());
  const auto attention = running_.server->service().attend("Vision");
  ASSERT_OK(attention);
  const uint64_t refused = counts().refused;
  EXPECT_FAILS(tell(ring_.id(), old), StatusCode::kDataLoss, "entry 0 was overwritten");
  EXPECT_FAILS(tell(ring_.id(), gone), StatusCode::kDataLoss, "entry 1 was overwritten");
  EXPECT_FAILS(tell(ring_.id(), gone), StatusCode::kDataLoss, "entry 1 was overwritten");
  EXPECT_EQ(counts().refused, refused + 2) << "each counts once";
}

TEST_F(SensoryHostile, TakesBackWhatItWrote) {
  open_ring();
  const auto attention = running_.server->service().attend("Vision");
  ASSERT_OK(attention);
  words()[1] = 100;
  EXPECT_FAILS(tell(ring_.id(), 100), StatusCode::kDataLoss, "entry 99");
  words()[1] = 5;
  EXPECT_FAILS(tell(ring_.id(), 5), StatusCode::kFailedPrecondition, "was closed");
  // It may begin anew.
  const uint64_t before = ring_.id();
  open_ring();
  EXPECT_NE(ring_.id(), before);
}

TEST_F(SensoryHostile, ChangesItsEntriesWhileTheyAreRead) {
  open_ring();
  std::jthread changing([this](const std::stop_token& stop) {
    std::mt19937_64 random(2);
    const SensoryLayout layout(memory_.bytes.size());
    const std::string head = head_of(kLeft, 0, 1000).SerializeAsString();
    for (uint64_t sequence = 0; !stop.stop_requested(); ++sequence) {
      uint64_t* said = &words()[layout.slot_of(sequence) / 8];
      const uint64_t offset = layout.data_begin() + 64 * (random() % 100);
      const uint64_t sizes[] = {sequence, 1,           static_cast<uint64_t>(to_ns(system_now())),
                                offset,   head.size(), 2000};
      std::ranges::copy(sizes, said);
      std::ranges::copy(as_bytes(head), memory_.bytes.begin() + static_cast<long>(offset) + 2000);
      words()[layout.data_begin() / 8 + random() % 1000] = random();
      __atomic_store_n(&words()[1], sequence + 1, __ATOMIC_RELEASE);
    }
  });
  memory::MemoryService& service = running_.server->service();
  for (int i = 0; i < 300; ++i) {
    auto attention = service.attend("Vision");
    ASSERT_OK(attention);
    std::this_thread::sleep_for(1ms);
    ASSERT_LE(counts().held, 256u) << "there are no more slots";
  }
  EXPECT_GT(counts().refused, 0u);
}

}  // namespace
}  // namespace engram::server
