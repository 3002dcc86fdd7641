// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/core/status.h"

namespace engram {

/// An open file descriptor, which is closed with this object.
///
/// Threading: read_at is const-parallel, sync may run beside append; everything else one thread.
class File {
 public:
  enum class Mode { kRead, kCreate, kAppend, kWrite };

  /// kCreate fails where the file exists. kAppend and kWrite create it where it does not exist, and
  /// kWrite is for write_at. Pipes,
  /// devices and directories are refused at once: they never end, or wait for somebody. Errors:
  /// kNotFound, kAlreadyExists, kUnavailable naming the path and the system's reason.
  static Result<File> open(const std::filesystem::path& path, Mode mode);

  File(File&& other) noexcept : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)) {}
  File& operator=(File&& other) noexcept;
  ~File();

  /// Writes all of `bytes` at the end.
  /// Errors: kResourceExhausted where the disk is full, otherwise kUnavailable.
  Status append(std::span<const std::byte> bytes);

  /// Writes all of `bytes` at `offset`; the file must have been opened with kWrite.
  /// Errors: as of append.
  Status write_at(uint64_t offset, std::span<const std::byte> bytes);

  /// Reads exactly `out.size()` bytes from `offset`.
  /// Errors: kDataLoss where the file ends earlier, kUnavailable.
  Status read_at(uint64_t offset, std::span<std::byte> out) const;

  /// Forces what was written to disk.
  Status sync();

  /// Truncates the file to `size` bytes.
  Status truncate(uint64_t size);

  Result<uint64_t> size() const;

  enum class LockKind { kExclusive, kShared };

  /// Takes a lock, which is released with this object or its process. Any number of shared ones
  /// exclude exclusive ones. Returns false where another holds one and `should_wait` is false.
  Result<bool> lock(bool should_wait, LockKind kind = LockKind::kExclusive);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  File(std::filesystem::path path, int fd) : path_(std::move(path)), fd_(fd) {}

  std::filesystem::path path_;
  int fd_ = -1;
};

/// Reads a whole file.
/// Errors: kNotFound, kUnavailable.
Result<Buffer> read_file(const std::filesystem::path& path);

/// Writes a new file, forces it to disk and renames it to `path`: readers see the old or the new
/// file.
Status replace_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Forces a finished file to disk and renames it to its final name, on the same file system.
Status publish_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// Forces the names in a directory to disk, so that created and renamed files survive a crash.
Status sync_directory(const std::filesystem::path& directory);

/// The free space of the file system of `path` for this user. Unit: bytes.
/// Errors: kUnavailable.
Result<uint64_t> free_disk_bytes(const std::filesystem::path& path);

/// Creates a directory and those above it.
/// Errors: kUnavailable.
Status make_directories(const std::filesystem::path& path);

/// Removes a file; ok where it does not exist.
Status remove_file(const std::filesystem::path& path);

}  // namespace engram
