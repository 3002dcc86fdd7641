// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/impl/service_type.h>

#include <memory>

#include "server/rpc/rpc_context.h"

namespace engram::server {

/// The gRPC service of a memory server. `context` outlives it.
/// Source: docs/wire.md.
[[nodiscard]] std::unique_ptr<grpc::Service> make_memory_rpc(RpcContext& context);

/// Tells subscribers what was committed otherwise than over a stream.
void publish(RpcContext& context, const ltm::Admission& admission);

}  // namespace engram::server
