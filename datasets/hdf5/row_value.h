// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: one row of an array as a value, and back.

#include <optional>
#include <string>

#include "ltm/h5/h5_array.h"
#include "ltm/idf/data.h"

namespace engram::datasets {

/// What the rows of an array are to people.
enum class RowRole : uint8_t {
  kImage,       ///< {"image": uint8 [H, W, 1 or 3]}.
  kDepth,       ///< {"depth": [H, W, 1]}.
  kCompressed,  ///< {"image"} of a JPEG or PNG file, padded with zeros.
  kValues,      ///< {"value": number}, {"values": [...]} or {"text"}.
};

/// "uint8", "float16", "bool", "text", "fixed_text", "bytes".
[[nodiscard]] std::string dtype_name(const h5::Element& element);

/// One row of numbers as a value. Needs the bytes of a row (checked), and no kCompressed.
[[nodiscard]] idf::Data row_value(const h5::ArrayInfo& info, RowRole role,
                                  std::span<const std::byte> bytes);

/// An image file, RGB as OpenCV wrote it of BGR. Zeros at the end are left out.
/// Errors: kDataLoss.
[[nodiscard]] Result<idf::Data> compressed_row_value(std::span<const std::byte> file);

/// What numbers, arrays and texts are in a row; nothing for other values.
struct RowForm {
  h5::Element element;
  std::vector<uint64_t> shape;  ///< Of one row; empty: one number.

  friend bool operator==(const RowForm&, const RowForm&) = default;
};
[[nodiscard]] std::optional<RowForm> row_form(const idf::Data& value);

/// The bytes of a value that row_form takes for numbers.
[[nodiscard]] std::vector<std::byte> row_bytes(const idf::Data& value);

}  // namespace engram::datasets
