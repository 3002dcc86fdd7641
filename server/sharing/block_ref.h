// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace engram::server {

/// One connected process. The application names them; a name may be used again when its connection
/// has closed.
using ClientId = uint64_t;

/// The server as one that writes blocks; no client has this name.
inline constexpr ClientId kServerItself = 0;

/// What access is given to: who may read one block of a group may read all of them.
using GroupId = uint32_t;

/// Shared memory of one group and one writer, divided into blocks. Never used twice.
using SlabId = uint64_t;

/// A block of shared memory, as it is told to other processes. Only a name: what comes from outside
/// is compared with what was leased.
struct BlockRef {
  SlabId slab = 0;
  uint64_t offset = 0;      ///< In the slab. Unit: bytes, a multiple of 64.
  uint64_t capacity = 0;    ///< Unit: bytes, a multiple of 64.
  uint64_t generation = 0;  ///< Of this lease, unlike all others of the pool; above zero.

  friend bool operator==(const BlockRef&, const BlockRef&) = default;
};

/// Random bytes that show, once, that a connection belongs to a client.
using Ticket = std::array<std::byte, 32>;

}  // namespace engram::server
