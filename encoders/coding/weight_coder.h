// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::encoders {

/// What the checksum of a matrix covers beside its bytes.
[[nodiscard]] uint64_t shape_identity(size_t rows, size_t columns);

/// Codes the 8-bit weights of a network's matrices, one matrix after the other, and goes on
/// learning from each: who decodes takes them in the order in which they were encoded.
///
/// How large a weight is likely to be is told by those above it in its column and those before it
/// in its row. Integer arithmetic only. Every matrix ends in a checksum of 32 bits.
/// Shape: [rows, columns], row by row; a row is an output channel.
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "The model file".
class WeightCoder {
 public:
  WeightCoder();
  ~WeightCoder();
  WeightCoder(const WeightCoder&) = delete;
  WeightCoder& operator=(const WeightCoder&) = delete;

  /// `weights` hold whole rows (checked).
  [[nodiscard]] std::vector<std::byte> encode(std::span<const int8_t> weights, size_t columns);

  /// Reads `rows * columns` weights. Safe on hostile bytes. `what` names the matrix in messages.
  /// Errors: kDataLoss where the checksum does not fit, which covers the shape too.
  Result<std::vector<int8_t>> decode(std::span<const std::byte> bytes, size_t rows, size_t columns,
                                     std::string_view what);

 private:
  template <typename Port>
  void code(Port& port, std::span<int8_t> weights, size_t columns);

  struct Model;
  std::unique_ptr<Model> model_;
};

}  // namespace engram::encoders
