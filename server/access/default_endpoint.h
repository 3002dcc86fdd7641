// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "server/access/endpoint.h"

namespace engram::server {

/// Returns the endpoint at which a server listens, and programs look for it, by default:
/// engram.sock, or engram-NAME.sock for a server with another name than "engram", in
/// $XDG_RUNTIME_DIR, else in /tmp/engram-UID.
/// Errors: kInvalidArgument if the name cannot be part of a path, or the path is too long.
Result<Endpoint> default_endpoint(std::string_view server = "engram");

/// Makes the folder of a socket if it does not exist, accessible to this user alone. Does nothing
/// for other endpoints.
/// Errors: kUnavailable; kFailedPrecondition if the folder in /tmp belongs to another user.
Status prepare_folder(const Endpoint& endpoint);

}  // namespace engram::server
