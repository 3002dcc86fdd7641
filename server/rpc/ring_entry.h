// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include <string>

#include "ltm/core/buffer.h"
#include "server/rpc/rpc_context.h"
#include "server/sharing/sensory_ring.h"

namespace engram::server {

/// Copies what an entry of a ring says besides its data. `budget` is how many bytes may still be
/// copied, and is lowered.
/// Errors: kNotFound if the entry was overwritten meanwhile; kDataLoss for what cannot be.
Result<v1::CommitRequest> read_ring_head(const SensoryRingReader& reader, const SensoryEntry& entry,
                                         size_t& budget);

/// Copies the data of a commit, all of one memory, to one buffer of this process, and has the
/// message say where.
/// Errors: as read_ring_head().
Result<Buffer> copy_ring_data(RpcContext& context, const std::string& memory,
                              const SensoryRingReader& reader, const SensoryEntry& entry,
                              v1::CommitRequest& message, size_t& budget);

}  // namespace engram::server
