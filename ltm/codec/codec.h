// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// Turns one ndarray into fewer bytes and back.
///
/// Threading: const-parallel.
class Codec {
 public:
  virtual ~Codec() = default;

  /// The name that is stored with the bytes: never changes.
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// True where decode gives back the identical array.
  [[nodiscard]] virtual bool is_lossless() const = 0;

  [[nodiscard]] virtual bool accepts(idf::ElementType type, const idf::Shape& shape) const = 0;

  /// Errors: kInvalidArgument where it does not accept the array.
  virtual Result<std::vector<std::byte>> encode(const idf::NdArray& array) const = 0;

  /// Decodes an array that must be of this type and shape. Safe on hostile bytes.
  /// Errors: kDataLoss where the bytes hold anything else.
  virtual Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                                      const idf::Shape& shape) const = 0;
};

/// Every codec, in no particular order. They live as long as the program.
[[nodiscard]] std::span<const Codec* const> all_codecs();

/// Null where there is none of this name.
[[nodiscard]] const Codec* find_codec(std::string_view name);

}  // namespace engram::ltm
