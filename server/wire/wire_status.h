// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/support/status.h>

#include "ltm/core/status.h"

namespace engram::server {

[[nodiscard]] grpc::StatusCode to_grpc_code(StatusCode code);
[[nodiscard]] grpc::Status to_grpc(const Status& status);

/// A code that only gRPC has becomes the nearest of ours; the message names the original.
[[nodiscard]] Status to_status(grpc::StatusCode code, const std::string& message);
[[nodiscard]] Status to_status(const grpc::Status& status);

}  // namespace engram::server
