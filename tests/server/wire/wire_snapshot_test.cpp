// SPDX-License-Identifier: Apache-2.0
#include "server/wire/wire_snapshot.h"

#include <gmock/gmock.h>

#include "ltm/idf/binary.h"
#include "server/wire/byte_message.h"
#include "server/wire/wire_status.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram::server {
namespace {

using ::testing::HasSubstr;

constexpr const char* kEntity = "Vision/RGB/head\\/left/cam";

ltm::Snapshot example(RandomValues& random) {
  ltm::Snapshot snapshot{
      *ltm::MemoryId::parse(kEntity), time_from_ns(static_cast<int64_t>(random.bits())), {}};
  for (size_t count = 1 + random.below(3); count > 0; --count) {
    ltm::Instance instance{random.value(3), {}};
    instance.metadata.created = time_from_ns(static_cast<int64_t>(random.below(1000)));
    instance.metadata.sent = time_from_ns(-5);
    instance.metadata.arrived = time_from_ns(7);
    instance.metadata.provider = "someone";
    if (count == 2) {
      instance.metadata.origin = *ltm::MemoryId::parse("a/b/c/d/2022-02-18 13:06:56/0");
      instance.metadata.recipe = "{}";
    }
    instance.metadata.confidence = count == 1 ? 1.0f : 0.25f;
    snapshot.instances.push_back(std::move(instance));
  }
  return snapshot;
}

/// Over the wire and back.
v1::Snapshot sent(const WireBytes& bytes) {
  auto buffer = bytes.to_byte_buffer();
  v1::Snapshot message;
  EXPECT_OK(read_message(buffer, message));
  return message;
}

TEST(WireSnapshot, CarriesCommits) {
  RandomValues random(3);
  for (int round = 0; round < 200; ++round) {
    v1::CommitRequest request;
    ltm::Commit commit;
    for (size_t count = random.below(4); count > 0; --count) {
      commit.updates.push_back(example(random));
      *request.add_updates() = *to_message(commit.updates.back());
    }
    auto taken = take_commit(request, {});
    ASSERT_OK(taken);
    EXPECT_EQ(taken->commit, commit);
    ASSERT_EQ(taken->encoded.size(), commit.updates.size());
    for (size_t i = 0; i < commit.updates.size(); ++i)
      for (size_t k = 0; k < commit.updates[i].instances.size(); ++k)
        EXPECT_EQ(*idf::decode(taken->encoded[i][k]), commit.updates[i].instances[k].data);
  }
}

TEST(WireSnapshot, CarriesEvents) {
  RandomValues random(4);
  for (const bool has_bytes : {false, true}) {
    const ltm::Snapshot snapshot = example(random);
    std::vector<Buffer> encoded;
    if (has_bytes)
      for (const ltm::Instance& instance : snapshot.instances)
        encoded.push_back(Buffer::take(*idf::encode(instance.data)));
    const ltm::SharedSnapshot shared = ltm::hold_untyped(snapshot, std::move(encoded));
    const ltm::HeldSnapshot& held = *shared;
    auto with_data = sent(to_wire(held, true));
    const auto all = take_snapshot(with_data, {});
    ASSERT_OK(all);
    EXPECT_EQ(*all, static_cast<const ltm::Snapshot&>(held));
    auto named = sent(to_wire(held, false));
    const auto ids = take_snapshot(named, {});
    ASSERT_OK(ids);
    EXPECT_EQ(ids->id(), held.id());
    EXPECT_EQ(ids->instances.size(), held.instances.size());
    EXPECT_EQ(ids->instances[0], ltm::Instance());
  }
}

TEST(WireSnapshot, CarriesEverythingThatAnAnswerSays) {
  ltm::SnapshotResult answer;
  answer.time = time_from_ns(42);
  answer.source = ltm::Source::kPredicted;
  answer.model = "Vision/RGB/head/cam v1";
  answer.predictor = "latent";
  answer.horizon = std::chrono::milliseconds(400);
  answer.plan = "Robot/Plan/a/b";
  ltm::InstanceMetadata metadata;
  metadata.provider = "someone";
  metadata.confidence = 0.5f;
  answer.append(int64_t{5}, metadata, ltm::MeasuredError{0.25, 0.5}, ltm::MeasuredError{1, 2});
  answer.instances[0].members = {
      {"pose/position", "quadratic", 0.25, std::nan(""), 0, false, true},
      {"image", "deep", 9, 25, 0.5, true, false},
      {"mode", "copy-last", std::nan(""), std::nan(""), 1, false, false, false}};
  answer.append(std::string("x"), {}, ltm::MeasuredError{}, std::nullopt);
  const auto bytes = to_wire(answer, true);
  ASSERT_OK(bytes);
  auto message = sent(*bytes);
  const auto taken = take_answer(message, {});
  ASSERT_OK(taken);
  EXPECT_EQ(taken->instances[0], answer.instances[0]);
  ASSERT_TRUE(taken->instances[1].error.has_value());
  EXPECT_TRUE(std::isnan(taken->instances[1].error->image_mse)) << "not known";
  EXPECT_EQ(taken->model, answer.model);
  EXPECT_EQ(taken->predictor, answer.predictor);
  EXPECT_EQ(taken->horizon, answer.horizon);
  EXPECT_EQ(taken->plan, answer.plan);
  EXPECT_EQ(taken->source, answer.source);
  EXPECT_EQ(taken->time, answer.time);
}

/// Each is refused, and the message says why.
TEST(WireSnapshot, RefusesHostileCommits) {
  const auto commit = [](const auto& change) {
    v1::CommitRequest request;
    v1::Snapshot& update = *request.add_updates();
    update.set_entity("A/b/c/d");
    const auto one = *idf::encode(int64_t{1});
    update.add_instances()->set_data(one.data(), one.size());
    change(update);
    return take_commit(request, {}).status();
  };
  EXPECT_OK(commit([](v1::Snapshot&) {}));
  EXPECT_FAILS(commit([](v1::Snapshot& update) { update.set_entity("A/b"); }),
               StatusCode::kInvalidArgument, "needs that of an entity");
  EXPECT_FAILS(commit([](v1::Snapshot& update) { update.set_entity(std::string(1 << 20, '/')); }),
               StatusCode::kInvalidArgument, "update 0");
  EXPECT_FAILS(commit([](v1::Snapshot& update) { update.set_entity("A/b/c/d/2022-01-01"); }),
               StatusCode::kInvalidArgument, "");
  EXPECT_FAILS(commit([](v1::Snapshot& update) {
                 update.mutable_instances(0)->set_data(std::string(100, '\xff'));
               }),
               StatusCode::kDataLoss, "A/b/c/d");
  EXPECT_FAILS(commit([](v1::Snapshot& update) {
                 update.mutable_instances(0)->mutable_shared()->set_offset(UINT64_MAX);
                 update.mutable_instances(0)->mutable_shared()->set_size(UINT64_MAX);
               }),
               StatusCode::kInvalidArgument, "of a block, which has 0");
}

TEST(WireSnapshot, FindsBytesInABlockAndNotBeyondIt) {
  const auto encoded = *idf::encode(std::string("hello"));
  std::string text = "___";
  text += as_text(std::span(encoded));
  const Buffer block = Buffer::copy(as_bytes(text));
  for (const auto& [offset, size, is_inside] :
       std::vector<std::tuple<uint64_t, uint64_t, bool>>{{3, encoded.size(), true},
                                                         {3, encoded.size() + 1, false},
                                                         {4, UINT64_MAX - 3, false},
                                                         {UINT64_MAX, 1, false},
                                                         {block.size() + 1, 0, false}}) {
    v1::Snapshot message;
    message.set_entity("A/b/c/d");
    message.add_instances()->mutable_shared()->set_offset(offset);
    message.mutable_instances(0)->mutable_shared()->set_size(size);
    const auto taken = take_snapshot(message, block);
    EXPECT_EQ(taken.ok(), is_inside) << offset << ' ' << size;
    if (!taken.ok()) continue;
    EXPECT_EQ(taken->instances[0].data, idf::Data(std::string("hello")));
  }
}

TEST(WireSnapshot, RefusesSourcesThatThereAreNot) {
  v1::Snapshot message;
  message.set_source(static_cast<v1::Source>(99));
  EXPECT_FAILS(take_answer(message, {}), StatusCode::kDataLoss, "source 99");
}

TEST(WireStatus, KeepsCodesAndMessages) {
  for (int code = 0; code <= static_cast<int>(StatusCode::kCancelled); ++code) {
    const auto ours = static_cast<StatusCode>(code);
    const Status status = ours == StatusCode::kOk ? Status() : Status(ours, "a message");
    EXPECT_EQ(to_status(to_grpc(status)).to_string(), status.to_string());
    EXPECT_EQ(to_status(to_outcome(status)).to_string(), status.to_string());
  }
  v1::Outcome strange;
  strange.set_code(12345);
  EXPECT_EQ(to_status(strange).code(), StatusCode::kUnavailable);
}

}  // namespace
}  // namespace engram::server
