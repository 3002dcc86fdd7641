// SPDX-License-Identifier: Apache-2.0
#include "server/access/default_endpoint.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace engram::server {

namespace {

std::string folder_in_tmp() {
  return fmt::format("/tmp/engram-{}", ::getuid());
}

std::string default_folder() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  // Services have no such variable, and its specification says to ignore a path that is not
  // absolute.
  if (runtime != nullptr && runtime[0] == '/') {
    std::string folder = runtime;
    while (folder.size() > 1 && folder.ends_with('/')) folder.pop_back();
    return folder;
  }
  return folder_in_tmp();
}

}  // namespace

Result<Endpoint> default_endpoint(std::string_view server) {
  if (server.empty() || server.find('/') != std::string_view::npos)
    return invalid_argument("server '{}': its name cannot be that of a socket, needs 'listen'",
                            server);
  const std::string file =
      server == "engram" ? "engram.sock" : fmt::format("engram-{}.sock", server);
  return Endpoint::parse(fmt::format("unix:{}/{}", default_folder(), file));
}

Status prepare_folder(const Endpoint& endpoint) {
  if (endpoint.kind() != Endpoint::Kind::kUnix) return {};
  const std::filesystem::path folder = std::filesystem::path(endpoint.path()).parent_path();
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    return unavailable("endpoint '{}': its folder cannot be made: {}", endpoint.to_string(),
                       std::strerror(errno));
  // Any user may have made the folder in /tmp, so its owner and mode are checked.
  if (folder != folder_in_tmp()) return {};
  struct stat about {};
  if (::lstat(folder.c_str(), &about) != 0 || !S_ISDIR(about.st_mode) ||
      about.st_uid != ::getuid() || (about.st_mode & 077) != 0)
    return failed_precondition(
        "endpoint '{}': found a folder that others made or can change, needs one of this user "
        "alone",
        endpoint.to_string());
  return {};
}

}  // namespace engram::server
