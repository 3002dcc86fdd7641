// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/support/status.h>

#include "ltm/core/status.h"

namespace engram::server {

[[nodiscard]] grpc::StatusCode to_grpc_code(StatusCode code);
[[nodiscard]] grpc::Status to_grpc(const Status& status);

/// Codes that only gRPC has become the nearest of ours; the message says which it was.
[[nodiscard]] Status to_status(grpc::StatusCode code, const std::string& message);
[[nodiscard]] Status to_status(const grpc::Status& status);

}  // namespace engram::server
