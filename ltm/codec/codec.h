// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// Turns one ndarray into fewer bytes and back.
///
/// Threading: const-parallel.
/// Source: docs/codecs.md.
class Codec {
 public:
  virtual ~Codec() = default;

  /// The name that is stored with the bytes: never changes. Decoding needs nothing else: whatever
  /// options made the bytes, any codec of that name reads them.
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// True where decode gives back the identical array.
  [[nodiscard]] virtual bool is_lossless() const = 0;

  /// What a lossy codec keeps, with these options, of an image that changes smoothly; infinity
  /// where lossless. Texture and noise may lose more: docs/codecs.md has measured values.
  /// Unit: dB of the peak signal to noise ratio.
  [[nodiscard]] virtual double psnr_db() const;

  [[nodiscard]] virtual bool accepts(idf::ElementType type, const idf::Shape& shape) const = 0;

  /// Equal arrays give equal bytes.
  /// Errors: kInvalidArgument where it does not accept the array.
  virtual Result<std::vector<std::byte>> encode(const idf::NdArray& array) const = 0;

  /// Decodes an array that must be of this type and shape. Safe on hostile bytes.
  /// Errors: kDataLoss where the bytes hold anything else.
  virtual Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                                      const idf::Shape& shape) const = 0;
};

/// Every codec with its default options, in no particular order. They live as long as the program.
[[nodiscard]] std::span<const Codec* const> all_codecs();

/// Null where there is none of this name.
[[nodiscard]] const Codec* find_codec(std::string_view name);

/// A codec by its name and options: "rowpred", "png:1", "jpeg:90" (ltm/codec/codec_text.h).
/// Errors: kInvalidArgument naming the codecs there are, the option or its range.
Result<std::shared_ptr<const Codec>> make_codec(std::string_view text);

}  // namespace engram::ltm
