// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

namespace engram {

namespace {

Status system_error(const std::filesystem::path& path, std::string_view what, int error) {
  const std::string message =
      fmt::format("'{}': {}: {}", path.string(), what, std::generic_category().message(error));
  switch (error) {
    case ENOENT:
      return Status(StatusCode::kNotFound, message);
    case EEXIST:
      return Status(StatusCode::kAlreadyExists, message);
    case ENOSPC:
    case EDQUOT:
      return Status(StatusCode::kResourceExhausted, message);
    default:
      return Status(StatusCode::kUnavailable, message);
  }
}

/// Opening must not wait for the other end of a named pipe. Regular files are read and written all
/// the same.
constexpr int kEvery = O_CLOEXEC | O_NONBLOCK | O_NOCTTY;

int flags_of(File::Mode mode) {
  switch (mode) {
    case File::Mode::kRead:
      return O_RDONLY | kEvery;
    case File::Mode::kCreate:
      return O_RDWR | O_CREAT | O_EXCL | O_APPEND | kEvery;
    case File::Mode::kWrite:
      return O_RDWR | O_CREAT | kEvery;
    case File::Mode::kAppend:
      break;
  }
  return O_RDWR | O_CREAT | O_APPEND | kEvery;
}

std::string_view kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISFIFO(mode)) return "a named pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

Status not_regular(const std::filesystem::path& path, mode_t mode) {
  return unavailable("'{}': found {}, needs a regular file", path.string(), kind_of(mode));
}

}  // namespace

Result<File> File::open(const std::filesystem::path& path, Mode mode) {
  const int fd = ::open(path.c_str(), flags_of(mode), 0644);
  if (fd < 0) {
    const int error = errno;
    // A socket, or a pipe that nobody reads, cannot even be opened.
    struct stat other {};
    if (error == ENXIO && ::stat(path.c_str(), &other) == 0)
      return not_regular(path, other.st_mode);
    return system_error(path, "cannot open", error);
  }
  File file(path, fd);
  struct stat info {};
  if (::fstat(fd, &info) != 0) return system_error(path, "cannot inspect", errno);
  if (!S_ISREG(info.st_mode)) return not_regular(path, info.st_mode);
  return file;
}

File& File::operator=(File&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(fd_, other.fd_);
  return *this;
}

File::~File() {
  if (fd_ >= 0) ::close(fd_);
}

Status File::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return system_error(path_, "cannot write", errno);
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
  return {};
}

Status File::write_at(uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return system_error(path_, "cannot write", errno);
    bytes = bytes.subspan(static_cast<size_t>(written));
    offset += static_cast<uint64_t>(written);
  }
  return {};
}

Status File::read_at(uint64_t offset, std::span<std::byte> out) const {
  while (!out.empty()) {
    const ssize_t count = ::pread(fd_, out.data(), out.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return system_error(path_, "cannot read", errno);
    if (count == 0)
      return data_loss("'{}': ends at byte {}, needs {} more", path_.string(), offset, out.size());
    out = out.subspan(static_cast<size_t>(count));
    offset += static_cast<uint64_t>(count);
  }
  return {};
}

Status File::sync() {
  // Unlike fsync it does not write the times of the file; the size is written by both.
  if (::fdatasync(fd_) != 0) return system_error(path_, "cannot force to disk", errno);
  return {};
}

Status File::truncate(uint64_t size) {
  if (::ftruncate(fd_, static_cast<off_t>(size)) != 0)
    return system_error(path_, "cannot truncate", errno);
  return {};
}

Result<uint64_t> File::size() const {
  struct stat info {};
  if (::fstat(fd_, &info) != 0) return system_error(path_, "cannot inspect", errno);
  return static_cast<uint64_t>(info.st_size);
}

Result<bool> File::lock(bool should_wait, LockKind kind) {
  const int how = kind == LockKind::kShared ? LOCK_SH : LOCK_EX;
  while (::flock(fd_, should_wait ? how : how | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    if (errno == EWOULDBLOCK) return false;
    return system_error(path_, "cannot lock", errno);
  }
  return true;
}

Result<Buffer> read_file(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const File file, File::open(path, File::Mode::kRead));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  std::vector<std::byte> bytes(size);
  ENGRAM_RETURN_IF_ERROR(file.read_at(0, bytes));
  return Buffer::take(std::move(bytes));
}

Status replace_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::filesystem::path beside = path;
  beside += ".new";
  // A crash may have left one.
  ENGRAM_RETURN_IF_ERROR(remove_file(beside));
  {
    ENGRAM_ASSIGN_OR_RETURN(File file, File::open(beside, File::Mode::kCreate));
    ENGRAM_RETURN_IF_ERROR(file.append(bytes));
  }
  return publish_file(beside, path);
}

Status publish_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  {
    ENGRAM_ASSIGN_OR_RETURN(File file, File::open(from, File::Mode::kRead));
    ENGRAM_RETURN_IF_ERROR(file.sync());
  }
  // Only now: a rename may reach the disk before the bytes of the file.
  if (::rename(from.c_str(), to.c_str()) != 0) return system_error(from, "cannot rename", errno);
  return sync_directory(to.parent_path());
}

Status sync_directory(const std::filesystem::path& path) {
  // A path without a directory lies in the working directory.
  const std::filesystem::path directory = path.empty() ? "." : path;
  const int fd = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return system_error(directory, "cannot open", errno);
  const int outcome = ::fsync(fd);
  const int error = errno;
  ::close(fd);
  if (outcome != 0) return system_error(directory, "cannot force to disk", error);
  return {};
}

Result<uint64_t> free_disk_bytes(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(path, error);
  if (error) return unavailable("'{}': {}", path.string(), error.message());
  return space.available;
}

Status make_directories(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return system_error(path, "cannot make directory", error.value());
  return {};
}

Status remove_file(const std::filesystem::path& path) {
  if (::unlink(path.c_str()) != 0 && errno != ENOENT)
    return system_error(path, "cannot remove", errno);
  return {};
}

}  // namespace engram
