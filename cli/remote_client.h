// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "cli/remote.h"
#include "server/client/memory_client.h"
#include "server/names/registration.h"

namespace engram::cli {

/// Returns all servers that the name system knows.
/// Errors: kUnavailable.
Result<std::vector<server::Registration>> known_servers(const RemoteArguments& arguments);

/// Connects to the named server, to ask what it reports about itself.
Result<std::unique_ptr<server::MemoryClient>> open_client(const RemoteArguments& arguments);

}  // namespace engram::cli
