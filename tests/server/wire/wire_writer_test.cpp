// SPDX-License-Identifier: Apache-2.0
#include "server/wire/wire_writer.h"

#include <engram/v1/memory.pb.h>
#include <gtest/gtest.h>

#include "server/wire/byte_message.h"

namespace engram::server {
namespace {

/// As the other side would read it.
template <typename Message>
Message read(WireWriter& writer) {
  auto bytes = writer.take().to_byte_buffer();
  Message message;
  EXPECT_TRUE(read_message(bytes, message).ok());
  return message;
}

TEST(WireWriter, WritesWhatProtobufReads) {
  for (const size_t size : {0u, 1u, 127u, 128u, 4095u, 4096u, 100'000u}) {
    const std::string data(size, 'x');
    WireWriter writer;
    writer.field(v1::Instance::kProviderFieldNumber, "somebody");
    writer.field(v1::Instance::kDataFieldNumber, Buffer::copy(as_bytes(data)));
    writer.field(v1::Instance::kCreatedNsFieldNumber, static_cast<uint64_t>(int64_t{-5}));
    EXPECT_GT(writer.size(), size);
    const auto message = read<v1::Instance>(writer);
    EXPECT_EQ(message.data(), data);
    EXPECT_EQ(message.provider(), "somebody");
    EXPECT_EQ(message.created_ns(), -5);
  }
}

TEST(WireWriter, SaysHowLargeAFieldIs) {
  for (const size_t size : {0u, 127u, 128u, 16'383u, 16'384u, 3'000'000u}) {
    WireWriter writer;
    writer.field(v1::Instance::kDataFieldNumber, Buffer::copy(as_bytes(std::string(size, 'x'))));
    EXPECT_EQ(writer.size(), WireWriter::field_size(v1::Instance::kDataFieldNumber, size));
  }
}

TEST(WireWriter, SharesLargeBytes) {
  const Buffer large = Buffer::copy(as_bytes(std::string(1 << 20, 'x')));
  WireWriter inner;
  inner.field(v1::Instance::kDataFieldNumber, large);
  const WireBytes instance = inner.take();
  WireWriter outer;
  outer.field(v1::Snapshot::kInstancesFieldNumber, instance);
  bool is_shared = false;
  const WireBytes bytes = outer.take();
  for (const grpc::Slice& piece : bytes.pieces)
    is_shared = is_shared || reinterpret_cast<const std::byte*>(piece.begin()) == large.data();
  EXPECT_TRUE(is_shared);
}

TEST(WireWriter, BeginsAnewOnceItIsTaken) {
  WireWriter writer;
  writer.field(v1::Instance::kProviderFieldNumber, "one");
  (void)writer.take();
  EXPECT_EQ(writer.size(), 0u);
  writer.field(v1::Instance::kProviderFieldNumber, "two");
  EXPECT_EQ(read<v1::Instance>(writer).provider(), "two");
}

}  // namespace
}  // namespace engram::server
