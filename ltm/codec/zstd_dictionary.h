// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/core/status.h"

namespace engram::ltm {

/// The common content of many small values, so that each frame stores only what differs.
///
/// Frames have no magic number and do not name their dictionary; store `id` and `bytes` beside
/// them. With another dictionary they decode to an error or to other bytes.
/// Threading: immutable, const-parallel. Copies share the tables.
/// Source: docs/codecs.md, section "Dictionaries".
class ZstdDictionary {
 public:
  struct Options {
    /// Max size of the dictionary. About a hundredth of the data that it is used for pays off.
    /// Unit: bytes, 256 to 1 MiB.
    size_t max_bytes = 16 << 10;
    int level = 3;  ///< 1 to 19; a higher level compresses more slowly.

    [[nodiscard]] Status validate() const;
  };

  /// Trains a dictionary on samples; a few hundred suffice. Equal samples give equal dictionaries.
  /// Errors: kInvalidArgument if the options do not validate, or if the samples are too few or too
  /// small.
  static Result<ZstdDictionary> train(std::span<const Buffer> samples, const Options& options);

  /// Makes a dictionary from the bytes of another one, as returned by `bytes`.
  /// Errors: kDataLoss if they are not a dictionary.
  static Result<ZstdDictionary> from_bytes(Buffer bytes, int level = 3);

  [[nodiscard]] uint32_t id() const { return id_; }
  [[nodiscard]] const Buffer& bytes() const { return bytes_; }

  [[nodiscard]] std::vector<std::byte> compress(std::span<const std::byte> bytes) const;

  /// Decompresses a frame. Safe on hostile bytes: nothing is allocated beyond `max_size`.
  /// Errors: kDataLoss.
  Result<std::vector<std::byte>> decompress(std::span<const std::byte> bytes,
                                            size_t max_size) const;

 private:
  struct Tables;
  ZstdDictionary(Buffer bytes, uint32_t id, std::shared_ptr<const Tables> tables)
      : bytes_(std::move(bytes)), id_(id), tables_(std::move(tables)) {}

  Buffer bytes_;
  uint32_t id_ = 0;
  std::shared_ptr<const Tables> tables_;
};

}  // namespace engram::ltm
