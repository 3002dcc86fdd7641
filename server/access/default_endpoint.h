// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "server/access/endpoint.h"

namespace engram::server {

/// Where a server listens, and programs look for it, when nobody says otherwise: engram.sock, or
/// engram-NAME.sock where it has another name than "engram", in $XDG_RUNTIME_DIR, else in
/// /tmp/engram-UID.
/// Errors: kInvalidArgument where the name cannot be part of a path, or that is too long.
Result<Endpoint> default_endpoint(std::string_view server = "engram");

/// Makes the folder of a socket where there is none, for this user alone. Fine for other endpoints.
/// Errors: kUnavailable; kFailedPrecondition where the folder in /tmp belongs to somebody else.
Status prepare_folder(const Endpoint& endpoint);

}  // namespace engram::server
