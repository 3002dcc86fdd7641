// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/vault/secret_bytes.h"
#include "ltm/core/file.h"

namespace engram::datasets::vault {

/// Random bytes that name a file, or a vault.
using RandomId = std::array<std::byte, 16>;

/// 32 hexadecimal digits.
[[nodiscard]] std::string to_text(const RandomId& id);

inline constexpr size_t kSealedHeaderBytes = 32;
inline constexpr size_t kPlainChunkBytes = 64 << 10;
inline constexpr size_t kSealBytes = 16;

/// Encrypts bytes by AES-256-GCM in chunks, with a key that seals this one file and nothing else.
///
/// The number of a chunk and whether it is the last are its nonce; these and the header are sealed
/// with it. So no chunk fits another place or another file, and a file that ends early is found.
/// Memory: one chunk.
///
/// Threading: one thread.
/// Source: docs/vault.md, section "A file of a day".
class SealedFileWriter {
 public:
  /// Makes a new file. The key must never have sealed anything.
  /// Errors, also of the functions below: kResourceExhausted if the disk is full, else
  /// kUnavailable.
  static Result<SealedFileWriter> create(const std::filesystem::path& path, const RandomId& id,
                                         const SecretKey& key);

  SealedFileWriter(SealedFileWriter&&) noexcept;
  ~SealedFileWriter();

  Status append(std::span<const std::byte> bytes);

  /// Seals the last chunk; nothing may follow. It does not force the file to the disk.
  Status finish();

  /// The size of the file so far. Unit: bytes.
  [[nodiscard]] uint64_t file_bytes() const;

 private:
  struct State;
  explicit SealedFileWriter(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

/// Reads what SealedFileWriter wrote. Nothing is given out that its seal does not fit.
///
/// Memory: one chunk. Threading: one thread.
class SealedFileReader {
 public:
  /// Errors: kDataLoss if the file is not called, or does not begin, as `id` needs it; those of
  /// File.
  static Result<SealedFileReader> open(const std::filesystem::path& path, const RandomId& id,
                                       const SecretKey& key);

  SealedFileReader(SealedFileReader&&) noexcept;
  ~SealedFileReader();

  /// Errors: kDataLoss naming the chunk whose seal does not fit, or if fewer bytes are left.
  Status read(std::span<std::byte> out);

  /// Plain bytes that were not read yet, by the size of the file.
  [[nodiscard]] uint64_t bytes_left() const;

 private:
  struct State;
  explicit SealedFileReader(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

/// Checks what can be checked of a sealed file without its key: its header, whether that has the ID
/// `id`, and whether whole chunks can have its size.
/// Errors: kDataLoss; those of File.
Status check_sealed_file(const std::filesystem::path& path, const RandomId& id);

}  // namespace engram::datasets::vault
