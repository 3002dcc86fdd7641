// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/packet_coder.h"

#include <algorithm>

namespace engram::encoders {

namespace {

constexpr uint8_t kDelimiter = 2;
/// In the head of a unit: a size follows, and nothing else does.
constexpr uint8_t kHasSize = 2;

/// Bit `at` of a head, or 2 beyond its end.
size_t bit_of(const std::vector<uint8_t>& head, size_t at) {
  if (at / 8 >= head.size()) return 2;
  return (head[at / 8] >> (7 - at % 8)) & 1;
}

void put_unit(uint8_t type, std::span<const std::byte> payload, std::vector<std::byte>& packet) {
  packet.push_back(static_cast<std::byte>(type << 3 | kHasSize));
  size_t size = payload.size();
  for (; size >= 128; size >>= 7) packet.push_back(static_cast<std::byte>(size | 128));
  packet.push_back(static_cast<std::byte>(size));
  packet.insert(packet.end(), payload.begin(), payload.end());
}

}  // namespace

Result<std::vector<PacketUnit>> split_units(const std::vector<std::byte>& packet) {
  std::vector<PacketUnit> units;
  for (size_t at = 0; at < packet.size();) {
    const auto head = std::to_integer<uint32_t>(packet[at++]);
    size_t size = 0;
    for (int shift = 0; at < packet.size() && shift < 28; shift += 7) {
      const auto byte = std::to_integer<size_t>(packet[at++]);
      size |= (byte & 127) << shift;
      if (byte < 128) break;
    }
    if (size > packet.size() - at) return invalid_argument("packet: a unit ends beyond its end");
    const auto begin = packet.begin() + static_cast<ptrdiff_t>(at);
    units.push_back(
        {static_cast<uint8_t>((head >> 3) & 15), {begin, begin + static_cast<ptrdiff_t>(size)}});
    at += size;
  }
  if (!units.empty()) units.erase(units.begin());
  if (units.size() > PacketCoder::kMaxUnits || join_units(units) != packet)
    return invalid_argument("packet: found units with heads of another kind");
  return units;
}

std::vector<std::byte> join_units(const std::vector<PacketUnit>& units) {
  std::vector<std::byte> packet;
  put_unit(kDelimiter, {}, packet);
  for (const PacketUnit& unit : units) put_unit(unit.type, unit.payload, packet);
  return packet;
}

PacketCoder::PacketCoder()
    : bits_({kClasses * kHeadBits * 27, kHeadBits * 256 * 3, kHashes, kClasses * kHeadBits,
             kHeadBits * 9 * 16},
            kHeadBits) {}

PacketCoder::HeadBits::Contexts PacketCoder::contexts(const Head& head, size_t i, size_t bit,
                                                      size_t node) const {
  // The class is known after four bits. Until then, the class of the last frame tells more.
  const size_t kind =
      head.empty() ? (bit < 4 ? last_class_ : node >> (bit - 4) & 15) : head[0] >> 4;
  const auto& past = past_[kind];
  const size_t at = 8 * i + bit;
  const size_t newest = bit_of(past[0], at);
  const size_t older = 3 * bit_of(past[1], at) + bit_of(past[2], at);
  const size_t byte = i < past[0].size() ? past[0][i] : size_t{256};
  const size_t hash = ((((kind * kHeadBytes + i) * 257 + byte) * 256 + node) * 0x9e3779b1u) >> 12;
  const size_t before = at > 0 ? bit_of(past[0], at - 1) : 0;
  const size_t last_bits = (i > 0 ? head[i - 1] & 3u : 0u) * 4 + (node & 3);
  return {(kind * kHeadBits + at) * 27 + newest * 9 + older, (at * 256 + node) * 3 + newest,
          hash % kHashes, kind * kHeadBits + at, ((at * 3 + newest) * 3 + before) * 16 + last_bits};
}

}  // namespace engram::encoders
