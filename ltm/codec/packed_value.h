// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/idf/data.h"

namespace engram::ltm {

/// An ndarray that left its value and went through a codec.
struct PackedMedium {
  std::string path;   ///< Where it belongs in the value.
  std::string codec;  ///< Name of the codec (ltm/codec/codec.h).
  idf::ElementType type = idf::ElementType::kUInt8;
  idf::Shape shape;
  Buffer bytes;
};

/// A value as it is stored: its media encoded apart, the rest as it was.
struct PackedValue {
  idf::Data rest;  ///< The value with `none` where media were.
  std::vector<PackedMedium> media;
};

struct PackOptions {
  /// Codec of image members; one that does not accept a member is replaced by "zstd".
  std::string image_codec = "png";
};

/// Errors: kInvalidArgument where the codec is unknown or fails.
Result<PackedValue> pack(const idf::Data& value, const PackOptions& options);

/// Errors: kDataLoss where media do not decode to what was packed.
Result<idf::Data> unpack(const PackedValue& packed);

}  // namespace engram::ltm
