// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "cli/remote.h"
#include "server/client/memory_client.h"
#include "server/names/registration.h"

namespace engram::cli {

/// All servers that the name system knows.
/// Errors: kUnavailable.
Result<std::vector<server::Registration>> known_servers(const RemoteArguments& arguments);

/// The server that was named, for what it says of itself.
Result<std::unique_ptr<server::MemoryClient>> open_client(const RemoteArguments& arguments);

}  // namespace engram::cli
