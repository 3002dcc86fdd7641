// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>

#include "ltm/core/file.h"
#include "ltm/core/status.h"
#include "server/sharing/descriptor.h"

namespace engram::server {

/// The address of a Unix socket.
/// Errors: kInvalidArgument where the path is empty or longer than the system takes.
Status check_socket_path(const std::filesystem::path& path);

/// A socket that is connected to what listens at `path`, and waits at most so long for it.
/// Errors: kInvalidArgument, kUnavailable.
Result<Descriptor> connect_socket(const std::filesystem::path& path, int timeout_ms);

/// Listens at a path of the file system, alone.
///
/// A lock beside it ("<path>.lock", empty, never removed) tells whether a server lives: it goes
/// with its process, however that ends. What a dead one left at the path is replaced. Threading:
/// one thread. Owns: the path, which is removed with this.
class ListeningSocket {
 public:
  /// Errors: kInvalidArgument; kFailedPrecondition where a server listens there, the path is no
  /// socket, or its directory may be changed by anybody; kUnavailable.
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
