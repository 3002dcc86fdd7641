// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/packet_coder.h"

#include <gtest/gtest.h>

#include <random>

#include "encoders/coding/binary_coder.h"

namespace engram::encoders {
namespace {

using Packets = std::vector<std::vector<PacketUnit>>;

std::vector<std::byte> to_bytes(std::initializer_list<int> numbers) {
  std::vector<std::byte> bytes;
  for (const int number : numbers) bytes.push_back(static_cast<std::byte>(number));
  return bytes;
}

/// Packets of frames whose first bytes are nearly alike, as in a video.
Packets some_packets() {
  std::mt19937 random(3);
  Packets packets;
  for (int i = 0; i < 40; ++i) {
    auto& units = packets.emplace_back();
    if (i == 0) units.push_back({1, to_bytes({0, 0, 0, 36, 195, 63})});
    PacketUnit frame{6, {}};
    for (int at = 0; at < 60; ++at)
      frame.payload.push_back(
          static_cast<std::byte>(at < 20 ? 0x30 + at + (at == 3 ? i : 0) : random() % 256));
    units.push_back(frame);
    if (i % 2 == 1) units.push_back({3, to_bytes({0x80 + i % 8})});
    if (i % 7 == 0) units.push_back({5, {}});
  }
  return packets;
}

std::vector<std::byte> coded(Packets packets) {
  BinaryEncoder encoder;
  PacketCoder coder;
  for (auto& units : packets) EXPECT_TRUE(coder.code(encoder, units).ok());
  return encoder.finish();
}

TEST(PacketCoder, GivesBackThePackets) {
  const Packets packets = some_packets();
  const auto bytes = coded(packets);
  BinaryDecoder decoder(bytes);
  PacketCoder coder;
  for (const auto& units : packets) {
    std::vector<PacketUnit> decoded;
    ASSERT_TRUE(coder.code(decoder, decoded).ok());
    EXPECT_EQ(decoded, units);
  }
  // Twenty of the sixty bytes of a frame repeat.
  EXPECT_LT(bytes.size(), packets.size() * 47);
}

TEST(PacketCoder, SplitsAndJoinsPackets) {
  for (const auto& units : some_packets()) {
    const auto split = split_units(join_units(units));
    ASSERT_TRUE(split.ok()) << split.status().to_string();
    EXPECT_EQ(*split, units);
  }
}

TEST(PacketCoder, RefusesPacketsThatItWouldNotGiveBack) {
  const auto packet = join_units({{6, std::vector<std::byte>(200, std::byte{7})}});
  // A size that ends in a needless byte, one beyond the end, another first unit, and no unit.
  for (const auto& other : {to_bytes({0x12, 0x80, 0x00}), to_bytes({0x12, 0x00, 0x32, 0x05, 0x01}),
                            to_bytes({0x32, 0x00}), to_bytes({})})
    EXPECT_EQ(split_units(other).status().code(), StatusCode::kInvalidArgument) << other.size();
  for (size_t size = 3; size < packet.size(); ++size)
    EXPECT_FALSE(split_units({packet.begin(), packet.begin() + static_cast<ptrdiff_t>(size)}).ok());
  EXPECT_TRUE(split_units(packet).ok());
}

TEST(PacketCoder, DecodesAnyBytesWithinItsLimits) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::byte> bytes(random() % 400);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
    BinaryDecoder decoder(bytes);
    PacketCoder coder;
    size_t size = 0;
    for (int packet = 0; packet < 20; ++packet) {
      std::vector<PacketUnit> units;
      const Status status = coder.code(decoder, units);
      for (const PacketUnit& unit : units) size += unit.payload.size();
      EXPECT_LE(units.size(), PacketCoder::kMaxUnits);
      if (status.ok()) continue;
      EXPECT_EQ(status.code(), StatusCode::kDataLoss);
      break;
    }
    EXPECT_LE(size, PacketCoder::kMaxBytes);
  }
}

}  // namespace
}  // namespace engram::encoders
