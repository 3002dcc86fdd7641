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

/// The value that the checksum of a matrix covers beside its bytes.
[[nodiscard]] uint64_t shape_identity(size_t rows, size_t columns);

/// Codes the 8-bit weights of the matrices of a network. The models learn from one matrix to the
/// next, so matrices must be decoded in the order in which they were encoded.
///
/// The weights above in the column and before in the row predict the magnitude of a weight. It uses
/// integer arithmetic only. Every matrix ends in a checksum of 32 bits.
/// Shape: [rows, columns], row by row; a row is an output channel.
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "The model file".
class WeightCoder {
 public:
  WeightCoder();
  ~WeightCoder();
  WeightCoder(const WeightCoder&) = delete;
  WeightCoder& operator=(const WeightCoder&) = delete;

  /// `weights` must hold whole rows (checked).
  [[nodiscard]] std::vector<std::byte> encode(std::span<const int8_t> weights, size_t columns);

  /// Decodes `rows * columns` weights. It is safe on hostile bytes. `what` names the matrix in
  /// messages.
  /// Errors: kDataLoss if the checksum, which also covers the shape, does not fit.
  Result<std::vector<int8_t>> decode(std::span<const std::byte> bytes, size_t rows, size_t columns,
                                     std::string_view what);

 private:
  template <typename Port>
  void code(Port& port, std::span<int8_t> weights, size_t columns);

  struct Model;
  std::unique_ptr<Model> model_;
};

}  // namespace engram::encoders
