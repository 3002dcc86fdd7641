// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/rpc/rpc_context.h"

namespace engram::server {

/// What `engram info --server` shows.
[[nodiscard]] std::string figures_json(RpcContext& context);

/// The same for Prometheus.
[[nodiscard]] std::string metrics_text(RpcContext& context);

}  // namespace engram::server
