// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/listening_socket.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>

#include <algorithm>
#include <cstring>

namespace engram::server {

namespace {

constexpr int kBacklog = 64;

sockaddr_un address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::ranges::copy(path.native(), address.sun_path);
  return address;
}

Status path_status(const std::filesystem::path& path, std::string_view what) {
  return system_status(fmt::format("socket '{}': {}", path.string(), what));
}

Status check_directory(const std::filesystem::path& path) {
  const std::filesystem::path directory = path.has_parent_path() ? path.parent_path() : ".";
  struct stat found {};
  if (::stat(directory.c_str(), &found) != 0) return path_status(path, "cannot see its directory");
  const bool is_trusted = found.st_uid == ::geteuid() || found.st_uid == 0;
  const bool is_open_to_all = (found.st_mode & S_IWOTH) != 0 && (found.st_mode & S_ISVTX) == 0;
  if (!is_trusted || is_open_to_all)
    return failed_precondition(
        "socket '{}': its directory is of user {} with mode {:o}, needs to be ours and closed to "
        "others",
        path.string(), found.st_uid, found.st_mode & 07777);
  return {};
}

/// Returns zero or the system's error number.
int try_connect(const Descriptor& socket, const std::filesystem::path& path) {
  const sockaddr_un address = address_of(path);
  int outcome = 0;
  do {
    outcome = ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  } while (outcome != 0 && errno == EINTR);
  return outcome == 0 ? 0 : errno;
}

/// Removes the socket of a dead server.
Status clear(const std::filesystem::path& path) {
  struct stat found {};
  if (::lstat(path.c_str(), &found) != 0)
    return errno == ENOENT ? Status() : path_status(path, "cannot see it");
  if (!S_ISSOCK(found.st_mode))
    return failed_precondition("socket '{}': found something that is none", path.string());
  // A program that does not know our lock may listen here.
  const Descriptor probe(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!probe.is_open()) return path_status(path, "cannot make");
  if (try_connect(probe, path) != ECONNREFUSED)
    return failed_precondition("socket '{}': another server listens there", path.string());
  return remove_file(path);
}

}  // namespace

Status check_socket_path(const std::filesystem::path& path) {
  constexpr size_t kMax = sizeof(sockaddr_un::sun_path) - 1;
  if (path.empty() || path.native().size() > kMax)
    return invalid_argument("socket '{}': has {} bytes, needs 1 to {}", path.string(),
                            path.native().size(), kMax);
  return {};
}

Result<Descriptor> connect_socket(const std::filesystem::path& path, int timeout_ms) {
  ENGRAM_RETURN_IF_ERROR(check_socket_path(path));
  Descriptor socket(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) return path_status(path, "cannot make");
  const timeval timeout{timeout_ms / 1000, timeout_ms % 1000 * 1000};
  ::setsockopt(socket.get(), SOL_SOCKET, SO_SNDTIMEO, &timeout, sizeof(timeout));
  ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof(timeout));
  if (try_connect(socket, path) != 0) return path_status(path, "cannot connect");
  return socket;
}

Result<ListeningSocket> ListeningSocket::open(const std::filesystem::path& path, mode_t mode) {
  ENGRAM_RETURN_IF_ERROR(check_socket_path(path));
  ENGRAM_RETURN_IF_ERROR(check_directory(path));
  std::filesystem::path beside = path;
  beside += ".lock";
  ENGRAM_ASSIGN_OR_RETURN(File lock, File::open(beside, File::Mode::kAppend));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_ours, lock.lock(false));
  if (!is_ours)
    return failed_precondition("socket '{}': another server listens there", path.string());
  ENGRAM_RETURN_IF_ERROR(clear(path));
  Descriptor socket(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket.is_open()) return path_status(path, "cannot make");
  // Set before the socket has a name, so that it is never open to more users than intended.
  if (::fchmod(socket.get(), mode) != 0) return path_status(path, "cannot set its mode");
  const sockaddr_un address = address_of(path);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0)
    return path_status(path, "cannot bind");
  ListeningSocket listening(path, std::move(lock), std::move(socket));
  // bind() applied the umask of the process, so the mode is set again.
  if (::chmod(path.c_str(), mode) != 0) return path_status(path, "cannot set its mode");
  if (::listen(listening.get(), kBacklog) != 0) return path_status(path, "cannot listen");
  return listening;
}

ListeningSocket::~ListeningSocket() {
  // The path is removed while the lock is held: afterwards it may be the next server's socket.
  if (socket_.is_open()) ::unlink(path_.c_str());
}

}  // namespace engram::server
