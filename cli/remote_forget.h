// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/remote.h"

namespace engram::cli {

/// What a running server is to forget.
struct RemoteForget {
  RemoteArguments remote;
  std::vector<std::string> targets;
  bool erases = false;
  bool is_dry_run = false;
  bool is_json = false;
  bool is_confirmed = false;
};

/// Lets a server forget, after it asked unless that is confirmed already, and prints what was
/// done.
ExitCode forget_on_server(const RemoteForget& what);

}  // namespace engram::cli
