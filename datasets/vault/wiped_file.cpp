// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/wiped_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "ltm/core/file.h"
#include "ltm/core/printable.h"

namespace engram::datasets::vault {

namespace {

constexpr mode_t kOwnerAlone = S_IRUSR | S_IWUSR;
constexpr size_t kWipeBytes = 64 << 10;

class SecretDescriptor {
 public:
  explicit SecretDescriptor(int fd) : fd_(fd) {}
  SecretDescriptor(SecretDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  SecretDescriptor& operator=(SecretDescriptor&&) = delete;
  ~SecretDescriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_;
};

Status secret_file_error(const std::filesystem::path& path, std::string_view what) {
  const int error = errno;
  std::string message = fmt::format("'{}': {}: {}", printable(path.string()), what,
                                    std::generic_category().message(error));
  if (error == ENOENT) return Status(StatusCode::kNotFound, std::move(message));
  const bool is_full = error == ENOSPC || error == EDQUOT;
  return Status(is_full ? StatusCode::kResourceExhausted : StatusCode::kUnavailable,
                std::move(message));
}

std::filesystem::path beside(const std::filesystem::path& path, std::string_view suffix) {
  std::filesystem::path other = path;
  other += suffix;
  return other;
}

std::filesystem::path new_of(const std::filesystem::path& path) {
  return beside(path, ".replacing");
}

std::filesystem::path old_of(const std::filesystem::path& path) {
  return beside(path, ".replaced");
}

Status check_is_secret(const std::filesystem::path& path, const struct stat& info) {
  const std::string name = printable(path.string());
  if (!S_ISREG(info.st_mode)) return failed_precondition("'{}': is no plain file", name);
  if (info.st_uid != ::geteuid() && info.st_uid != 0)
    return failed_precondition("'{}': belongs to user {}, needs to be yours ({}) or root's", name,
                               info.st_uid, ::geteuid());
  if ((info.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return failed_precondition(
        "'{}': has the permissions {:04o}, needs 0600: others can read or change the keys in it; "
        "chmod 600 it",
        name, info.st_mode & 07777);
  return {};
}

Status write_at(const SecretDescriptor& file, const std::filesystem::path& path, off_t offset,
                std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(file.fd(), bytes.data(), bytes.size(), offset);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return secret_file_error(path, "cannot write");
    bytes = bytes.subspan(static_cast<size_t>(count));
    offset += count;
  }
  return {};
}

Status force(const SecretDescriptor& file, const std::filesystem::path& path) {
  return ::fsync(file.fd()) == 0 ? Status() : secret_file_error(path, "cannot force to disk");
}

/// Overwrites all bytes of a file. Random bytes, because file systems keep zeros as holes.
Status overwrite(const SecretDescriptor& file, const std::filesystem::path& path) {
  struct stat info {};
  if (::fstat(file.fd(), &info) != 0) return secret_file_error(path, "cannot inspect");
  std::vector<std::byte> noise(kWipeBytes);
  for (off_t at = 0; at < info.st_size; at += static_cast<off_t>(noise.size())) {
    ENGRAM_RETURN_IF_ERROR(fill_random(noise));
    const auto count = std::min<off_t>(info.st_size - at, static_cast<off_t>(noise.size()));
    ENGRAM_RETURN_IF_ERROR(
        write_at(file, path, at, std::span(noise).first(static_cast<size_t>(count))));
  }
  return force(file, path);
}

/// Opens a file whose bytes are to be overwritten. Root may open any file, so the permissions are
/// looked at as well: what its owner made read-only is not meant to change.
Result<SecretDescriptor> open_to_overwrite(const std::filesystem::path& path) {
  SecretDescriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW));
  struct stat info {};
  const bool is_refused = file.fd() < 0 && errno == EACCES;
  if (!is_refused) {
    if (file.fd() < 0) return secret_file_error(path, "cannot open it to overwrite it");
    if (::fstat(file.fd(), &info) != 0) return secret_file_error(path, "cannot inspect");
    ENGRAM_RETURN_IF_ERROR(check_is_secret(path, info));
  }
  if (is_refused || (info.st_mode & S_IWUSR) == 0)
    return failed_precondition(
        "'{}': may not be written, needs the permissions 0600: the keys in it could not be "
        "overwritten; chmod 600 it",
        printable(path.string()));
  return file;
}

/// Overwrites and removes a file; ok where there is none.
Status wipe(const std::filesystem::path& path) {
  const auto file = open_to_overwrite(path);
  if (file.status().code() == StatusCode::kNotFound) return {};
  ENGRAM_RETURN_IF_ERROR(file.status());
  ENGRAM_RETURN_IF_ERROR(overwrite(*file, path));
  return remove_file(path);
}

Status write_new(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  const SecretDescriptor file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, kOwnerAlone));
  if (file.fd() < 0) return secret_file_error(path, "cannot make it");
  ENGRAM_RETURN_IF_ERROR(write_at(file, path, 0, bytes));
  return force(file, path);
}

/// Renames `from` to `to` and overwrites what `to` held.
Status take_place(const std::filesystem::path& from, const std::filesystem::path& to) {
  const std::filesystem::path old = old_of(to);
  const auto before = open_to_overwrite(to);
  const bool is_first = before.status().code() == StatusCode::kNotFound;
  // Old bytes that cannot be overwritten must not lose the name by which they can be found.
  if (!is_first) ENGRAM_RETURN_IF_ERROR(before.status());
  // The second name is there for the next run, should this one be killed before it has overwritten
  // the old bytes. File systems without such names do without.
  if (!is_first) static_cast<void>(::link(to.c_str(), old.c_str()));
  if (::rename(from.c_str(), to.c_str()) != 0) return secret_file_error(from, "cannot rename");
  ENGRAM_RETURN_IF_ERROR(sync_directory(to.parent_path()));
  if (!is_first) ENGRAM_RETURN_IF_ERROR(overwrite(*before, to));
  return remove_file(old);
}

}  // namespace

Result<SecretBytes> read_secret_file(const std::filesystem::path& path) {
  const SecretDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  struct stat info {};
  if (file.fd() < 0 || ::fstat(file.fd(), &info) != 0)
    return secret_file_error(path, "cannot read");
  ENGRAM_RETURN_IF_ERROR(check_is_secret(path, info));
  SecretBytes bytes(static_cast<size_t>(info.st_size));
  size_t size = 0;
  while (size < bytes.size()) {
    const ssize_t count = ::read(file.fd(), bytes.data() + size, bytes.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return secret_file_error(path, "cannot read");
    if (count == 0) break;
    size += static_cast<size_t>(count);
  }
  bytes.resize(size);
  return bytes;
}

Status replace_secret_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  ENGRAM_RETURN_IF_ERROR(wipe_leftovers(path));
  const std::filesystem::path made = new_of(path);
  Status status = write_new(made, bytes);
  if (status.ok()) status = take_place(made, path);
  // Either it has its name now, or its keys must not stay beside the others.
  const Status wiped = wipe_leftovers(path);
  return status.ok() ? wiped : status;
}

Status check_replaceable(const std::filesystem::path& path) {
  const Status opened = open_to_overwrite(path).status();
  return opened.code() == StatusCode::kNotFound ? Status() : opened;
}

Status wipe_leftovers(const std::filesystem::path& path) {
  ENGRAM_RETURN_IF_ERROR(wipe(new_of(path)));
  const std::filesystem::path old = old_of(path);
  // A kill before the rename left a second name of the file itself.
  std::error_code error;
  if (std::filesystem::equivalent(path, old, error)) return remove_file(old);
  return wipe(old);
}

}  // namespace engram::datasets::vault
