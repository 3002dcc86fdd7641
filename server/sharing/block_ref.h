// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace engram::server {

/// One connected process. The application chooses the ID, which may be used again once the
/// connection has closed.
using ClientId = uint64_t;

/// The ID of the server itself as a writer of blocks; no client has it.
inline constexpr ClientId kServerItself = 0;

/// The unit of access: a client that may read one block of a group may read all its blocks.
using GroupId = uint32_t;

/// Shared memory of one group and one writer, divided into blocks. An ID is never used twice.
using SlabId = uint64_t;

/// The name of a block of shared memory, as sent to other processes. A name that a client sends is
/// compared with what was leased to it.
struct BlockRef {
  SlabId slab = 0;
  uint64_t offset = 0;      ///< Offset in the slab. Unit: bytes, a multiple of 64.
  uint64_t capacity = 0;    ///< Unit: bytes, a multiple of 64.
  uint64_t generation = 0;  ///< Unique to this lease within the pool; above zero.

  friend bool operator==(const BlockRef&, const BlockRef&) = default;
};

/// Random bytes that prove once that a connection belongs to a client.
using Ticket = std::array<std::byte, 32>;

}  // namespace engram::server
