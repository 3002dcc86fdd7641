// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "cli/remote.h"
#include "server/access/endpoint.h"

namespace engram::cli {

/// Registers what the robot of a live kitchen can do with the server that has the memory Skill, as
/// the provider `kitchen`, and carries it out until a stop is requested. While there is no such
/// server it tries again, and says so once. A stepped body stands still until they are registered.
/// Errors: kInvalidArgument if the server's endpoint is none.
Status provide_kitchen_skills(const server::Endpoint& bus, const RemoteArguments& remote,
                              const std::function<void(const std::string& words)>& say,
                              const std::stop_token& stop);

}  // namespace engram::cli
