// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>

#include "ltm/core/file.h"
#include "ltm/core/status.h"
#include "server/sharing/descriptor.h"

namespace engram::server {

/// Checks the path of a Unix socket.
/// Errors: kInvalidArgument if the path is empty or longer than the system allows.
Status check_socket_path(const std::filesystem::path& path);

/// Connects to the socket at `path` and waits for `timeout_ms` at most.
/// Errors: kInvalidArgument, kUnavailable.
Result<Descriptor> connect_socket(const std::filesystem::path& path, int timeout_ms);

/// Listens at a path of the file system, as the only server there.
///
/// A locked file beside it ("<path>.lock", empty, never removed) shows that a server lives: the
/// lock ends with its process, however that ends. A socket that a dead server left at the path is
/// replaced.
/// Threading: one thread.
/// Owns: the path, which is removed with this object.
class ListeningSocket {
 public:
  /// Errors: kInvalidArgument; kFailedPrecondition if a server listens there, the path is no
  /// socket, or any user may change its folder; kUnavailable.
  static Result<ListeningSocket> open(const std::filesystem::path& path, mode_t mode);

  ListeningSocket(ListeningSocket&& other) noexcept = default;
  ListeningSocket& operator=(ListeningSocket&& other) noexcept = delete;
  ~ListeningSocket();

  [[nodiscard]] int get() const { return socket_.get(); }

 private:
  ListeningSocket(std::filesystem::path path, File lock, Descriptor socket)
      : path_(std::move(path)), lock_(std::move(lock)), socket_(std::move(socket)) {}

  std::filesystem::path path_;
  File lock_;
  Descriptor socket_;
};

}  // namespace engram::server
