// SPDX-License-Identifier: Apache-2.0
#include "server/wire/wire_answer.h"

#include <engram/v1/memory.pb.h>
#include <gmock/gmock.h>

#include "ltm/idf/binary.h"
#include "server/wire/byte_message.h"
#include "server/wire/wire_snapshot.h"
#include "tests/ltm/expect_status.h"

namespace engram::server {
namespace {

ltm::RecalledSnapshot moment(int64_t at, size_t bytes) {
  ltm::RecalledSnapshot made;
  made.answer.time = time_from_ns(at);
  made.answer.append(std::string(bytes, static_cast<char>('a' + at % 26)), {});
  return made;
}

/// A moment that is in working memory, with the bytes as which it came.
ltm::RecalledSnapshot held_moment(int64_t at, size_t bytes) {
  ltm::Snapshot snapshot{*ltm::MemoryId::parse("A/b/c/d"), time_from_ns(at), {}};
  std::vector<Buffer> encoded;
  for (int i = 0; i < 3; ++i) {
    snapshot.instances.push_back({std::string(bytes, static_cast<char>('x' + i)), {}});
    encoded.push_back(Buffer::take(*idf::encode(snapshot.instances.back().data)));
  }
  return ltm::recalled(ltm::hold_untyped(std::move(snapshot), std::move(encoded)), {0, 2}, false);
}

/// Its parts as the other side reads them.
std::vector<v1::QueryReply> parts(const ltm::Answer& answer, size_t part_bytes) {
  std::vector<v1::QueryReply> all;
  const auto take = [&all](const WireBytes& bytes) {
    auto buffer = bytes.to_byte_buffer();
    EXPECT_OK(read_message(buffer, all.emplace_back()));
  };
  EXPECT_OK(write_answer(7, answer, part_bytes, true, take));
  return all;
}

/// What the parts say together, as a client puts it together.
ltm::QueryResult united(std::vector<v1::QueryReply> all, bool is_ids_only) {
  ltm::QueryResult result(is_ids_only);
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].number(), 7u);
    EXPECT_EQ(all[i].is_last(), i + 1 == all.size());
    for (v1::EntityAnswer& entity : *all[i].mutable_entities()) {
      ltm::EntityResult& one = result.add_entity(*ltm::MemoryId::parse(entity.entity()));
      for (v1::Snapshot& snapshot : *entity.mutable_snapshots())
        one.add(*take_answer(snapshot, {}));
    }
  }
  return result;
}

ltm::Answer example() {
  ltm::Answer answer;
  answer.entities.push_back({*ltm::MemoryId::parse("A/b/c/empty"), {}});
  for (const char* entity : {"A/b/c/d", "B/b/c/d"}) {
    answer.entities.push_back({*ltm::MemoryId::parse(entity), {}});
    for (int64_t at = 1; at <= 20; ++at)
      answer.entities.back().snapshots.push_back(at % 3 == 0 ? held_moment(at, 5000)
                                                             : moment(at, 200));
  }
  return answer;
}

TEST(WireAnswer, SaysTheSameInAnyNumberOfParts) {
  const ltm::Answer answer = example();
  for (const size_t part_bytes : {1u, 1000u, 20'000u, 10'000'000u}) {
    const auto all = parts(answer, part_bytes);
    EXPECT_EQ(united(all, false), ltm::Answer(answer).to_result()) << part_bytes;
    if (part_bytes == 1u) {
      EXPECT_GE(all.size(), 40u);
    }
    if (part_bytes == 10'000'000u) {
      EXPECT_EQ(all.size(), 1u);
    }
    // One alone may be as large as its largest snapshot.
    for (const v1::QueryReply& part : all) EXPECT_LT(part.ByteSizeLong(), part_bytes + 12'000);
  }
}

TEST(WireAnswer, IsOnePartWhereThereIsNothing) {
  const auto all = parts({}, 1000);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_TRUE(all[0].is_last());
  EXPECT_EQ(all[0].number(), 7u);
}

TEST(WireAnswer, TellsIdsAlone) {
  ltm::Answer answer = example();
  answer.is_ids_only = true;
  for (ltm::RecalledEntity& entity : answer.entities)
    for (ltm::RecalledSnapshot& snapshot : entity.snapshots)
      for (ltm::InstanceResult& instance : snapshot.answer.instances)
        instance = {instance.index, {}, {}};
  const auto all = parts(answer, 1000);
  EXPECT_EQ(united(all, true), ltm::Answer(answer).to_result());
}

}  // namespace
}  // namespace engram::server
