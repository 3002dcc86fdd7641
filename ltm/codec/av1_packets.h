// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// The packets of a group of the codec "av1", one per picture in the order of time, without the
/// frame of lengths that the group has around them. Who codes the packets in a shorter way needs
/// them alone.
struct Av1Packets {
  bool is_deep = true;  ///< Coded with a depth of 10 bits, else of 8.
  std::vector<std::vector<std::byte>> packets;

  friend bool operator==(const Av1Packets&, const Av1Packets&) = default;
};

/// Errors: kDataLoss if the bytes are no group, or not one packet per picture.
Result<Av1Packets> av1_packets(std::span<const std::byte> group);

/// The group of the codec "av1" that has these packets.
/// Shape: pictures [H, W, 1] or [H, W, 3] of 8 bits (checked).
std::vector<std::byte> av1_group(Av1Packets packets, const idf::Shape& shape);

}  // namespace engram::ltm
