// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <type_traits>

#include "ltm/core/time.h"
#include "server/sharing/block_ref.h"
#include "server/sharing/descriptor.h"

namespace engram::server {

/// A message between SharingServer and SharingClient: one packet, in the byte order of their host.
struct Message {
  /// Identifies the protocol and its version; each version has its own number.
  static constexpr uint32_t kMagic = 0x31485345;

  enum class Kind : uint32_t {
    kHello = 1,   ///< Client: `ticket`. The first message, sent once.
    kWelcome,     ///< Server: `status`; it closes unless that is ok.
    kOpenSlab,    ///< Client: `slab`.
    kSlab,        ///< Server: `slab`, `status`, and if ok `bytes`, `is_writer`, a descriptor.
    kSlabMapped,  ///< Client: has mapped `slab`, which it writes.
    kSlabSealed,  ///< Server: `slab`, `status`; ok: the client may write.
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
  Descriptor descriptor;  ///< The descriptor that came with it.
};

enum class Descriptors : bool { kRefuse, kAccept };

/// Sends a packet, with a descriptor unless it is negative.
/// Errors: kUnavailable if the peer is gone; kResourceExhausted if it does not read.
Status send_message(int socket, const Message& message, int descriptor = -1);

/// Receives the next packet; nothing if none arrives within the socket's timeout.
/// Errors: kUnavailable if the peer is gone; kDataLoss if the packet is no message.
Result<std::optional<Arrived>> receive_message(int socket, Descriptors descriptors);

/// Returns the status code of a message, or kDataLoss if it has an unknown one.
[[nodiscard]] StatusCode status_code(const Message& message);

}  // namespace engram::server
