// SPDX-License-Identifier: Apache-2.0
#include "server/access/private_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "ltm/core/file.h"

namespace engram::server {

namespace {

/// An open file that is closed with this object. It is opened without blocking, because opening a
/// pipe would wait for a writer.
class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& path)
      : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_;
};

Status system_error(const std::filesystem::path& path, int error) {
  const std::string message =
      fmt::format("'{}': cannot read: {}", path.string(), std::generic_category().message(error));
  return Status(error == ENOENT ? StatusCode::kNotFound : StatusCode::kUnavailable, message);
}

Status check_info(const std::filesystem::path& path, const struct stat& info) {
  if (!S_ISREG(info.st_mode)) return failed_precondition("'{}': is no plain file", path.string());
  if (info.st_uid != ::geteuid() && info.st_uid != 0)
    return failed_precondition("'{}': belongs to user {}, needs to be yours ({}) or root's",
                               path.string(), info.st_uid, ::geteuid());
  if ((info.st_mode & (S_IRWXO | S_IWGRP | S_IXGRP)) != 0)
    return failed_precondition(
        "'{}': has the permissions {:04o}, needs 0600 or 0640: others can read or change the "
        "secret in it; chmod 600 it",
        path.string(), info.st_mode & 07777);
  return {};
}

Status check_open(const std::filesystem::path& path, const OpenFile& file) {
  struct stat info {};
  if (file.fd() < 0 || ::fstat(file.fd(), &info) != 0) return system_error(path, errno);
  return check_info(path, info);
}

}  // namespace

Status check_private_file(const std::filesystem::path& path) {
  return check_open(path, OpenFile(path));
}

Result<std::string> read_private_file(const std::filesystem::path& path, size_t max_bytes) {
  const OpenFile file(path);
  ENGRAM_RETURN_IF_ERROR(check_open(path, file));
  std::string text(max_bytes + 1, '\0');
  size_t size = 0;
  while (size < text.size()) {
    const ssize_t count = ::read(file.fd(), text.data() + size, text.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return system_error(path, errno);
    if (count == 0) break;
    size += static_cast<size_t>(count);
  }
  if (size > max_bytes)
    return invalid_argument("'{}': has more than {} bytes, which are read at most", path.string(),
                            max_bytes);
  text.resize(size);
  return text;
}

Status create_private_file(const std::filesystem::path& path, std::string_view text) {
  constexpr mode_t kOwnerAlone = 0600;
  // The permissions are those of the first moment: nobody can open it before they are set.
  const int made = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kOwnerAlone);
  if (made < 0 && errno == EEXIST) return already_exists("'{}' is there already", path.string());
  if (made < 0)
    return unavailable("'{}': cannot make it: {}", path.string(),
                       std::generic_category().message(errno));
  ::close(made);
  ENGRAM_ASSIGN_OR_RETURN(File file, File::open(path, File::Mode::kAppend));
  ENGRAM_RETURN_IF_ERROR(file.append(as_bytes(text)));
  ENGRAM_RETURN_IF_ERROR(file.sync());
  return sync_directory(path.has_parent_path() ? path.parent_path() : ".");
}

}  // namespace engram::server
