// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/rpc/rpc_context.h"

namespace engram::server {

/// Returns the server's figures as JSON, for `engram info --server`. The last failure, which may
/// name entities, is only for `who` may read everything.
[[nodiscard]] std::string figures_json(RpcContext& context, const Identity& who);

/// Returns the server's metrics as text for Prometheus.
[[nodiscard]] std::string metrics_text(RpcContext& context);

}  // namespace engram::server
