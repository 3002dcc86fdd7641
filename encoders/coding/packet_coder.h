// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to the learning rooms.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "encoders/coding/integer_coder.h"
#include "encoders/coding/mixed_bits.h"
#include "ltm/core/status.h"

namespace engram::encoders {

/// A unit of an AV1 packet ("OBU"): its type and payload, without the head that says both.
struct PacketUnit {
  uint8_t type = 0;
  std::vector<std::byte> payload;

  friend bool operator==(const PacketUnit&, const PacketUnit&) = default;
};

/// Splits an AV1 packet into its units, without the delimiter that is the first of every packet.
/// Errors: kInvalidArgument if the units have other heads than libaom writes: join_units() would
/// not give the same bytes.
Result<std::vector<PacketUnit>> split_units(const std::vector<std::byte>& packet);

/// The packet of these units, with its delimiter.
[[nodiscard]] std::vector<std::byte> join_units(const std::vector<PacketUnit>& units);

/// Codes the units of consecutive AV1 packets without loss.
///
/// At low rates a third of an AV1 video is heads of frames, of some 20 bytes each, which AV1 codes
/// without models although they repeat. Here each bit at the start of a frame is told from the bits
/// at the same place of the frames before. What follows is coded already and is copied.
/// Threading: one thread.
class PacketCoder {
 public:
  /// Maximum number of units in a packet, and of bytes in all packets.
  static constexpr size_t kMaxUnits = 32;
  static constexpr size_t kMaxBytes = size_t{1} << 24;

  PacketCoder();

  /// Encodes the units, or decodes units into `units`. Any bits decode to some units.
  /// Errors: kDataLoss if there are more units or bytes than the maximum.
  template <typename Port>
  Status code(Port& port, std::vector<PacketUnit>& units);

 private:
  /// Modelled bytes at the start of a frame. Heads of frames are hardly longer.
  static constexpr size_t kHeadBytes = 22;
  static constexpr size_t kHeadBits = 8 * kHeadBytes;
  static constexpr size_t kTypes = 16;
  /// The first four bits of a frame say how it is shown and predicted.
  static constexpr size_t kClasses = 16;
  static constexpr size_t kHashes = size_t{1} << 16;
  static constexpr size_t kUnitPlaces = 3;

  using Head = std::vector<uint8_t>;
  using HeadBits = MixedBits<5>;

  template <typename Port>
  Status code_unit(Port& port, size_t place, uint8_t last_type, PacketUnit& unit);
  template <typename Port>
  void code_head(Port& port, std::vector<std::byte>& payload);
  /// The contexts of bit `bit` (from the highest one) of byte `i`; `node` is one and the higher
  /// bits of this byte.
  [[nodiscard]] HeadBits::Contexts contexts(const Head& head, size_t i, size_t bit,
                                            size_t node) const;

  size_t bytes_ = 0;
  HeadBits bits_;
  std::array<std::array<Head, 3>, kClasses> past_;  ///< [class, from the newest on].
  size_t last_class_ = 0;
  std::array<IntegerModel, kTypes> sizes_;
  std::array<std::array<AdaptiveBit, kTypes>, kUnitPlaces> more_;
  std::array<std::array<std::array<AdaptiveBit, kTypes>, kTypes>, kUnitPlaces> types_;
};

// Implementation of the templates.

template <typename Port>
Status PacketCoder::code(Port& port, std::vector<PacketUnit>& units) {
  uint8_t last_type = 0;
  for (size_t i = 0;; ++i) {
    const size_t place = std::min(i, kUnitPlaces - 1);
    if (!more_[place][last_type].code(port, i < units.size())) break;
    if (i == kMaxUnits) return data_loss("packet: found more than {} units", kMaxUnits);
    if constexpr (Port::kIsDecoder) units.emplace_back();
    ENGRAM_RETURN_IF_ERROR(code_unit(port, place, last_type, units[i]));
    last_type = units[i].type;
  }
  return {};
}

template <typename Port>
Status PacketCoder::code_unit(Port& port, size_t place, uint8_t last_type, PacketUnit& unit) {
  size_t node = 1;
  for (int shift = 3; shift >= 0; --shift)
    node = 2 * node + (types_[place][last_type][node].code(port, ((unit.type >> shift) & 1) != 0)
                           ? size_t{1}
                           : 0);
  unit.type = static_cast<uint8_t>(node - kTypes);
  const int64_t size = sizes_[unit.type].code(port, static_cast<int64_t>(unit.payload.size()));
  if (size < 0 || static_cast<uint64_t>(size) > kMaxBytes - bytes_)
    return data_loss("packet: found a unit of {} bytes, needs at most {}", size,
                     kMaxBytes - bytes_);
  bytes_ += static_cast<size_t>(size);
  if constexpr (Port::kIsDecoder) unit.payload.resize(static_cast<size_t>(size));
  constexpr uint8_t kFrameHead = 3;
  constexpr uint8_t kFrame = 6;
  const bool has_head = unit.type == kFrameHead || unit.type == kFrame;
  if (has_head) code_head(port, unit.payload);
  for (size_t i = has_head ? kHeadBytes : 0; i < unit.payload.size(); ++i)
    unit.payload[i] =
        static_cast<std::byte>(port.code_even(std::to_integer<uint32_t>(unit.payload[i]), 8));
  return {};
}

template <typename Port>
void PacketCoder::code_head(Port& port, std::vector<std::byte>& payload) {
  Head head;
  for (size_t i = 0; i < std::min(payload.size(), kHeadBytes); ++i) {
    const auto byte = std::to_integer<size_t>(payload[i]);
    size_t node = 1;
    for (size_t bit = 0; bit < 8; ++bit)
      node = 2 * node + (bits_.code(port, contexts(head, i, bit, node), 8 * i + bit,
                                    ((byte >> (7 - bit)) & 1) != 0)
                             ? size_t{1}
                             : 0);
    head.push_back(static_cast<uint8_t>(node));
    payload[i] = static_cast<std::byte>(head.back());
  }
  if (head.empty()) return;
  last_class_ = head[0] >> 4;
  auto& past = past_[last_class_];
  std::shift_right(past.begin(), past.end(), 1);
  past[0] = std::move(head);
}

}  // namespace engram::encoders
