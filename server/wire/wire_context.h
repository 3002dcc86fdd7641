// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include <memory>
#include <optional>

#include "ltm/recall/list_moments.h"

namespace engram::server {

/// Max bytes of the context of an entity as it is sent, and of all that come with a query: they
/// share a message with what else is told.
inline constexpr size_t kMaxContextBytes = size_t{32} << 20;
/// What one may take once it is unpacked: it compresses well, and who sends it may be hostile.
inline constexpr size_t kMaxUnpackedContextBytes = size_t{256} << 20;

/// Where snapshots of an entity were and in which context, as a server sends it; no `context` if
/// there is no such entity.
/// Errors: kResourceExhausted if it is too large.
Result<v1::EntityContext> to_message(const ltm::MemoryId& entity,
                                     const ltm::SharedContext& context);

/// Reads what to_message() wrote; safe on hostile messages.
/// Errors: kInvalidArgument naming what was found; kDataLoss.
Result<std::shared_ptr<const ltm::OtherContexts>> to_contexts(
    const google::protobuf::RepeatedPtrField<v1::EntityContext>& messages);

}  // namespace engram::server
