// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/binary_coder.h"
#include "encoders/coding/packet_coder.h"
#include "ltm/core/buffer.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::encoders {
namespace {

constexpr size_t kPackets = 6;

/// Decodes packets until there is one that is refused.
std::vector<std::vector<PacketUnit>> decoded_packets(std::span<const std::byte> bytes) {
  BinaryDecoder decoder(bytes);
  PacketCoder coder;
  std::vector<std::vector<PacketUnit>> packets;
  for (size_t i = 0; i < kPackets; ++i) {
    std::vector<PacketUnit> units;
    if (!coder.code(decoder, units).ok()) break;
    const auto split = split_units(join_units(units));
    ENGRAM_CHECK(split.ok() && *split == units, "units are lost in their packet");
    packets.push_back(std::move(units));
  }
  return packets;
}

}  // namespace
}  // namespace engram::encoders

/// Whatever the bytes are, they give packets that can be coded again, and a packet that can be
/// split is joined again.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::encoders;
  const auto bytes = as_bytes(fuzzed_text(data, size));
  const auto packets = decoded_packets(bytes);
  BinaryEncoder encoder;
  PacketCoder coder;
  for (auto units : packets) ENGRAM_CHECK(coder.code(encoder, units).ok(), "cannot code again");
  const std::vector<std::byte> again = encoder.finish();
  const auto same = decoded_packets(again);
  ENGRAM_CHECK(
      same.size() >= packets.size() && std::equal(packets.begin(), packets.end(), same.begin()),
      "coded again they are others");
  const std::vector<std::byte> packet(bytes.begin(), bytes.end());
  if (const auto units = split_units(packet); units.ok())
    ENGRAM_CHECK(join_units(*units) == packet, "joined they are others");
  return 0;
}
