// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/impl/service_type.h>

#include <memory>
#include <span>

#include "server/rpc/rpc_context.h"

namespace engram::server {

/// Makes the gRPC service of a memory server. `context` must outlive it.
/// Source: docs/wire.md.
[[nodiscard]] std::unique_ptr<grpc::Service> make_memory_rpc(RpcContext& context);

/// Notifies subscribers of snapshots that did not arrive over a stream.
void publish(RpcContext& context, std::span<const ltm::SharedSnapshot> snapshots);

}  // namespace engram::server
