// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: one row of an array as a value, and back.

#include <optional>
#include <string>

#include "ltm/h5/h5_array.h"
#include "ltm/idf/data.h"

namespace engram::datasets {

/// The meaning of the rows of an array.
enum class RowRole : uint8_t {
  kImage,       ///< {"image": uint8 [H, W, 1 or 3]}.
  kDepth,       ///< {"depth": [H, W, 1]}.
  kCompressed,  ///< {"image"} from a JPEG or PNG file, padded with zeros.
  kValues,      ///< {"value": number}, {"values": [...]} or {"text"}.
};

/// Returns "uint8", "float16", "bool", "text", "fixed_text", "bytes".
[[nodiscard]] std::string dtype_name(const h5::Element& element);

/// Converts one row of numbers to a value. `bytes` must be one row (checked), and the role not
/// kCompressed.
[[nodiscard]] idf::Data row_value(const h5::ArrayInfo& info, RowRole role,
                                  std::span<const std::byte> bytes);

/// Decodes an image file; it is RGB, as OpenCV wrote it from BGR. Zeros at the end are ignored.
/// Errors: kDataLoss.
[[nodiscard]] Result<idf::Data> compressed_row_value(std::span<const std::byte> file);

/// The form of numbers, arrays and texts in a row; row_form returns nothing for other values.
struct RowForm {
  h5::Element element;
  std::vector<uint64_t> shape;  ///< The shape of one row; empty for a number.

  friend bool operator==(const RowForm&, const RowForm&) = default;
};
[[nodiscard]] std::optional<RowForm> row_form(const idf::Data& value);

/// Returns the bytes of a value that has a RowForm of numbers.
[[nodiscard]] std::vector<std::byte> row_bytes(const idf::Data& value);

}  // namespace engram::datasets
