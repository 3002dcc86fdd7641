// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/private_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "ltm/core/file.h"
#include "ltm/core/printable.h"

namespace engram {

namespace {

constexpr mode_t kOwnerAlone = S_IRUSR | S_IWUSR;

Status private_file_error(const std::filesystem::path& path, std::string_view what, int error) {
  const std::string message = fmt::format("'{}': {}: {}", printable(path.string()), what,
                                          std::generic_category().message(error));
  switch (error) {
    case ENOENT:
      return Status(StatusCode::kNotFound, message);
    case ENOSPC:
    case EDQUOT:
      return Status(StatusCode::kResourceExhausted, message);
    default:
      return Status(StatusCode::kUnavailable, message);
  }
}

Status check_is_private(const std::filesystem::path& path, const struct stat& info,
                        SecretReaders readers) {
  const std::string name = printable(path.string());
  const bool is_for_group = readers == SecretReaders::kOwnerAndGroup;
  const mode_t others = S_IRWXO | (is_for_group ? S_IWGRP | S_IXGRP : S_IRWXG);
  if (!S_ISREG(info.st_mode)) return failed_precondition("'{}': is no plain file", name);
  if (info.st_uid != ::geteuid() && info.st_uid != 0)
    return failed_precondition("'{}': belongs to user {}, needs to be yours ({}) or root's", name,
                               info.st_uid, ::geteuid());
  if ((info.st_mode & others) != 0)
    return failed_precondition(
        "'{}': has the permissions {:04o}, needs {}: others can read or change the secret in it; "
        "chmod 600 it",
        name, info.st_mode & 07777, is_for_group ? "0600 or 0640" : "0600");
  return {};
}

Status not_writable(const std::filesystem::path& path) {
  return failed_precondition(
      "'{}': may not be written, needs the permissions 0600: the secret in it could not be "
      "overwritten; chmod 600 it",
      printable(path.string()));
}

}  // namespace

Result<PrivateFile> PrivateFile::open(const std::filesystem::path& path, Mode mode,
                                      SecretReaders readers) {
  const bool is_changed = mode == Mode::kOverwrite;
  // Without blocking, because opening a pipe would wait for its other end.
  const int flags = (is_changed ? O_WRONLY | O_NOFOLLOW : O_RDONLY) | O_CLOEXEC | O_NONBLOCK;
  PrivateFile file(path, ::open(path.c_str(), flags | O_NOCTTY));
  if (file.fd_ < 0 && is_changed && errno == EACCES) return not_writable(path);
  if (file.fd_ < 0)
    return private_file_error(path, is_changed ? "cannot open it to overwrite it" : "cannot read",
                              errno);
  struct stat info {};
  if (::fstat(file.fd_, &info) != 0) return private_file_error(path, "cannot inspect", errno);
  ENGRAM_RETURN_IF_ERROR(check_is_private(path, info, readers));
  // Root may open any file: what its owner made read-only is not meant to change all the same.
  if (is_changed && (info.st_mode & S_IWUSR) == 0) return not_writable(path);
  file.size_ = static_cast<uint64_t>(info.st_size);
  return file;
}

Result<PrivateFile> PrivateFile::create(const std::filesystem::path& path) {
  const int flags = O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW;
  // The permissions are those of the first moment: nobody can open it before they are set.
  PrivateFile file(path, ::open(path.c_str(), flags, kOwnerAlone));
  if (file.fd_ < 0 && errno == EEXIST)
    return already_exists("'{}' is there already", printable(path.string()));
  if (file.fd_ < 0) return private_file_error(path, "cannot make it", errno);
  return file;
}

PrivateFile::~PrivateFile() {
  if (fd_ >= 0) ::close(fd_);
}

Result<size_t> PrivateFile::read(std::span<std::byte> out) const {
  size_t size = 0;
  while (size < out.size()) {
    const ssize_t count =
        ::pread(fd_, out.data() + size, out.size() - size, static_cast<off_t>(size));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return private_file_error(path_, "cannot read", errno);
    if (count == 0) break;
    size += static_cast<size_t>(count);
  }
  return size;
}

Status PrivateFile::write_at(uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return private_file_error(path_, "cannot write", errno);
    bytes = bytes.subspan(static_cast<size_t>(count));
    offset += static_cast<uint64_t>(count);
  }
  return {};
}

Status PrivateFile::sync() {
  if (::fsync(fd_) != 0) return private_file_error(path_, "cannot force to disk", errno);
  return {};
}

Status check_private_file(const std::filesystem::path& path) {
  return PrivateFile::open(path, PrivateFile::Mode::kRead, SecretReaders::kOwnerAndGroup).status();
}

Result<std::string> read_private_file(const std::filesystem::path& path, size_t max_bytes) {
  ENGRAM_ASSIGN_OR_RETURN(const PrivateFile file, PrivateFile::open(path, PrivateFile::Mode::kRead,
                                                                    SecretReaders::kOwnerAndGroup));
  std::string text(max_bytes + 1, '\0');
  ENGRAM_ASSIGN_OR_RETURN(const size_t size, file.read(std::as_writable_bytes(std::span(text))));
  if (size > max_bytes)
    return invalid_argument("'{}': has more than {} bytes, which are read at most",
                            printable(path.string()), max_bytes);
  text.resize(size);
  return text;
}

Status create_private_file(const std::filesystem::path& path, std::string_view text) {
  ENGRAM_ASSIGN_OR_RETURN(PrivateFile file, PrivateFile::create(path));
  ENGRAM_RETURN_IF_ERROR(file.write_at(0, as_bytes(text)));
  ENGRAM_RETURN_IF_ERROR(file.sync());
  return sync_directory(path.parent_path());
}

}  // namespace engram
