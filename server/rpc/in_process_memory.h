// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "memory/memory.h"
#include "server/rpc/rpc_context.h"

namespace engram::server {

/// The memories of a server of this process, for a part of the server itself: without a network,
/// and without a token. Closing it does nothing.
/// `context` must outlive it.
[[nodiscard]] std::unique_ptr<Memory> in_process_memory(RpcContext& context);

}  // namespace engram::server
