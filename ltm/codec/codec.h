// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// Compresses one ndarray and decompresses it.
///
/// Threading: const-parallel.
/// Source: docs/codecs.md.
class Codec {
 public:
  virtual ~Codec() = default;

  /// The name that is stored with the bytes. It never changes. Decoding needs nothing else: a codec
  /// of this name reads bytes made with any options.
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// True if decode returns the identical array.
  [[nodiscard]] virtual bool is_lossless() const = 0;

  /// The quality that a lossy codec reaches with these options on an image that changes smoothly;
  /// infinity for a lossless codec. Texture and noise may lose more, see the measured values in
  /// docs/codecs.md.
  /// Unit: dB of the peak signal to noise ratio.
  [[nodiscard]] virtual double psnr_db() const;

  [[nodiscard]] virtual bool accepts(idf::ElementType type, const idf::Shape& shape) const = 0;

  /// Compresses an array. Equal arrays give equal bytes.
  /// Errors: kInvalidArgument if the codec does not accept the array.
  virtual Result<std::vector<std::byte>> encode(const idf::NdArray& array) const = 0;

  /// Decodes an array that must be of this type and shape. Safe on hostile bytes.
  /// Errors: kDataLoss if the bytes contain anything else.
  virtual Result<idf::NdArray> decode(std::span<const std::byte> bytes, idf::ElementType type,
                                      const idf::Shape& shape) const = 0;
};

/// All codecs with default options, in no particular order. They live as long as the program.
[[nodiscard]] std::span<const Codec* const> all_codecs();

/// The codec of this name, or null if there is none.
[[nodiscard]] const Codec* find_codec(std::string_view name);

/// Makes a codec from its name and options: "rowpred", "png:1", "jpeg:90" (ltm/codec/codec_text.h).
/// Errors: kInvalidArgument naming the existing codecs, the option or its range.
Result<std::shared_ptr<const Codec>> make_codec(std::string_view text);

}  // namespace engram::ltm
