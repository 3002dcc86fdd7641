// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/channel.h>

#include "server/access/endpoint.h"
#include "server/client/memory_client.h"

namespace engram::server {

/// A connection that is made when it is needed, and again when it broke.
/// Errors: those of reading the CA file.
Result<std::shared_ptr<grpc::Channel>> open_channel(const Endpoint& endpoint,
                                                    const ClientOptions& options);

}  // namespace engram::server
