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

/// What many small values have in common, so that each takes only what is its own.
///
/// The frames it makes have no magic number and do not name it: whoever stores them keeps `id` and
/// `bytes` beside them. With another dictionary they decode to an error or to other bytes.
/// Threading: immutable, const-parallel. Copies share the tables.
/// Source: docs/codecs.md, section "Dictionaries".
class ZstdDictionary {
 public:
  struct Options {
    /// Largest dictionary. About a hundredth of what it is for pays. Unit: bytes, 256 to 1 MiB.
    size_t max_bytes = 16 << 10;
    int level = 3;  ///< 1 to 19; more takes longer to compress with.

    [[nodiscard]] Status validate() const;
  };

  /// Learns from samples; a few hundred do. Equal samples give equal dictionaries.
  /// Errors: kInvalidArgument where the options do not validate or the samples are too few or too
  /// small to learn from.
  static Result<ZstdDictionary> train(std::span<const Buffer> samples, const Options& options);

  /// Takes what `bytes` gave.
  /// Errors: kDataLoss where they are no dictionary.
  static Result<ZstdDictionary> from_bytes(Buffer bytes, int level = 3);

  [[nodiscard]] uint32_t id() const { return id_; }
  [[nodiscard]] const Buffer& bytes() const { return bytes_; }

  [[nodiscard]] std::vector<std::byte> compress(std::span<const std::byte> bytes) const;

  /// Safe on hostile bytes: nothing is allocated beyond `max_size`.
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
