// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/remote.h"
#include "server/client/memory_client.h"
#include "server/names/registration.h"

namespace engram::cli {

/// Where Memory::connect, or a provider of skills, connects to.
struct Connection {
  std::string endpoint;
  ConnectOptions options;
};

/// Errors: kInvalidArgument; kUnavailable if the socket of a server does not exist.
Result<Connection> connection_of(const RemoteArguments& arguments);

/// Returns all servers that the name system knows.
/// Errors: kUnavailable.
Result<std::vector<server::Registration>> known_servers(const RemoteArguments& arguments);

/// Connects to the named server, to ask what it reports about itself.
Result<std::unique_ptr<server::MemoryClient>> open_client(const RemoteArguments& arguments);

}  // namespace engram::cli
