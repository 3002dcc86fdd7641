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

/// An open file descriptor, closed when this goes.
///
/// Threading: read_at is const-parallel, sync may run beside append; everything else one thread.
class File {
 public:
  enum class Mode { kRead, kCreate, kAppend };

  /// kCreate fails where the file exists. kAppend makes it where it does not.
  /// Errors: kNotFound, kAlreadyExists, kUnavailable naming the path and the system's reason.
  static Result<File> open(const std::filesystem::path& path, Mode mode);

  File(File&& other) noexcept : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)) {}
  File& operator=(File&& other) noexcept;
  ~File();

  /// Writes all of `bytes` at the end.
  /// Errors: kResourceExhausted where the disk is full, else kUnavailable.
  Status append(std::span<const std::byte> bytes);

  /// Reads exactly `out.size()` bytes from `offset`.
  /// Errors: kDataLoss where the file ends before, kUnavailable.
  Status read_at(uint64_t offset, std::span<std::byte> out) const;

  /// Forces what was written to the disk.
  Status sync();

  /// Cuts the file to `size` bytes.
  Status truncate(uint64_t size);

  Result<uint64_t> size() const;

  /// Takes an exclusive lock that goes with this object or its process.
  /// False where another holds it and `should_wait` is false.
  Result<bool> lock(bool should_wait);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  File(std::filesystem::path path, int fd) : path_(std::move(path)), fd_(fd) {}

  std::filesystem::path path_;
  int fd_ = -1;
};

/// Errors: kNotFound, kUnavailable.
Result<Buffer> read_file(const std::filesystem::path& path);

/// Writes beside `path`, forces it to disk and renames: readers see the old or the new file.
Status replace_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Forces a finished file to disk and moves it to its final name, on the same file system.
Status publish_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// Forces the names in a directory to disk.
Status sync_directory(const std::filesystem::path& directory);

/// Bytes that the file system of `path` has left for us.
/// Errors: kUnavailable.
Result<uint64_t> free_disk_bytes(const std::filesystem::path& path);

/// Errors: kUnavailable.
Status make_directories(const std::filesystem::path& path);

/// Removes a file; fine where it does not exist.
Status remove_file(const std::filesystem::path& path);

}  // namespace engram
