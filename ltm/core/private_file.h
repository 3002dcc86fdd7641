// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "ltm/core/status.h"

namespace engram {

/// Who may read a file with a secret; root may always.
enum class SecretReaders { kOwner, kOwnerAndGroup };

/// An open file with a secret in it: a regular file of this user or root that nobody else can
/// change, or read beyond what is said. The checks are made on the opened file, so it cannot be
/// exchanged between check and use.
///
/// Threading: one thread.
class PrivateFile {
 public:
  /// kOverwrite needs a file that its owner may write, and follows no link.
  enum class Mode { kRead, kOverwrite };

  /// Errors: kNotFound; kFailedPrecondition naming what to change; kUnavailable.
  static Result<PrivateFile> open(const std::filesystem::path& path, Mode mode,
                                  SecretReaders readers);

  /// Makes a new file that its owner alone can read from its first moment.
  /// Errors: kAlreadyExists, kResourceExhausted, kUnavailable.
  static Result<PrivateFile> create(const std::filesystem::path& path);

  PrivateFile(PrivateFile&& other) noexcept
      : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)), size_(other.size_) {}
  PrivateFile& operator=(PrivateFile&&) = delete;
  ~PrivateFile();

  /// The size of the file when it was opened. Unit: bytes.
  [[nodiscard]] uint64_t size() const { return size_; }

  /// Reads from the file's begin. Returns how many bytes there were: fewer than `out` has where the
  /// file ends. Errors: kUnavailable.
  Result<size_t> read(std::span<std::byte> out) const;

  /// Errors: kResourceExhausted if the disk is full, else kUnavailable.
  Status write_at(uint64_t offset, std::span<const std::byte> bytes);

  /// Forces the file to the disk. Errors: those of write_at.
  Status sync();

 private:
  PrivateFile(std::filesystem::path path, int fd) : path_(std::move(path)), fd_(fd) {}

  std::filesystem::path path_;
  int fd_;
  uint64_t size_ = 0;
};

/// Checks a file that its owner and group may read.
/// Errors: those of PrivateFile::open.
Status check_private_file(const std::filesystem::path& path);

/// Reads the text of a file that its owner and group may read, `max_bytes` at most.
/// Errors: those of PrivateFile::open; kInvalidArgument if it is longer.
Result<std::string> read_private_file(const std::filesystem::path& path, size_t max_bytes);

/// Writes a new file that its owner alone can read, and forces it to disk.
/// Errors: kAlreadyExists, kResourceExhausted, kUnavailable.
Status create_private_file(const std::filesystem::path& path, std::string_view text);

}  // namespace engram
