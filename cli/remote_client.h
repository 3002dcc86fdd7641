// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/remote.h"
#include "server/client/memory_client.h"
#include "server/names/registration.h"

namespace engram::cli {

/// Token, CA and timeout of the arguments and the environment (ENGRAM_TOKEN).
Result<server::ClientOptions> client_options(const RemoteArguments& arguments);

/// The endpoint that was named: --server, ENGRAM_SERVER, or the usual one where one listens there.
/// Errors: kInvalidArgument; kUnavailable where there is no such socket.
Result<std::string> named_endpoint(const RemoteArguments& arguments);

/// Servers that the name system knows for memories of such a name; empty: all.
/// Errors: kNotFound where it knows none; kUnavailable.
Result<std::vector<server::Registration>> known_servers(const RemoteArguments& arguments,
                                                        const std::string& memory);

/// The server of a memory, or the one that was named.
Result<std::unique_ptr<server::MemoryClient>> open_client(const RemoteArguments& arguments,
                                                          const std::string& memory);

/// The servers of all memories of such names, each once, or the one that was named.
Result<std::vector<std::unique_ptr<server::MemoryClient>>> open_clients(
    const RemoteArguments& arguments, const std::vector<std::string>& memories);

}  // namespace engram::cli
