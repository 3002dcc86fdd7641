// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/names.pb.h>
#include <grpcpp/impl/service_type.h>

#include <memory>

#include "server/access/access_policy.h"
#include "server/names/name_registry.h"

namespace engram::server {

[[nodiscard]] v1::ServerRecord to_message(const Registration& registration);
[[nodiscard]] Registration to_registration(const v1::ServerRecord& message);

/// Makes the gRPC service of the Memory Name System. `names` and `access` must outlive it.
/// Registering needs Right::kWrite for the memories, asking needs a token.
/// Owns: a thread that notifies clients that watch or wait.
/// Source: docs/wire.md.
[[nodiscard]] std::unique_ptr<grpc::Service> make_names_rpc(NameRegistry& names,
                                                            const AccessPolicy& access);

}  // namespace engram::server
