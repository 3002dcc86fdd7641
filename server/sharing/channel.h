// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <type_traits>

#include "ltm/core/time.h"
#include "server/sharing/block_ref.h"
#include "server/sharing/descriptor.h"

namespace engram::server {

/// What is said between SharingServer and SharingClient: one packet each, in the byte order of the
/// host that both are on.
struct Message {
  /// Names the protocol and its version: another one is another number.
  static constexpr uint32_t kMagic = 0x31485345;

  enum class Kind : uint32_t {
    kHello = 1,   ///< Client: `ticket`. First and once.
    kWelcome,     ///< Server: `status`; closes unless it is ok.
    kOpenSlab,    ///< Client: `slab`.
    kSlab,        ///< Server: `slab`, `status`, and if ok `bytes`, `is_writer`, a descriptor.
    kSlabMapped,  ///< Client: `slab`, which it writes.
    kSlabSealed,  ///< Server: `slab`, `status`: it may be written.
    kSlabGone,    ///< Server: `slab` was given back.
  };

  uint32_t magic = kMagic;
  Kind kind{};
  SlabId slab = 0;
  uint64_t bytes = 0;
  uint32_t status = 0;  ///< A StatusCode.
  uint32_t is_writer = 0;
  Ticket ticket{};
};
static_assert(sizeof(Message) == 64 && std::is_trivially_copyable_v<Message>);

struct Arrived {
  Message message;
  Descriptor descriptor;  ///< That came with it.
};

enum class Descriptors : bool { kRefuse, kAccept };

/// Sends a packet, and a descriptor where there is one.
/// Errors: kUnavailable where the peer is gone, kResourceExhausted where it does not read.
Status send_message(int socket, const Message& message, int descriptor = -1);

/// The next packet; nothing where none came in the time that the socket waits.
/// Errors: kUnavailable where the peer is gone, kDataLoss where it is no message.
Result<std::optional<Arrived>> receive_message(int socket, Descriptors descriptors);

/// The code that a message carries; kDataLoss where it is none.
[[nodiscard]] StatusCode status_code(const Message& message);

}  // namespace engram::server
