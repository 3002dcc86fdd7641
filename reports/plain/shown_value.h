// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/idf/type.h"

namespace engram::reports {

/// A value as the inspector shows it: as idf::to_json writes it, but without what nobody reads.
///
///     {"$image": {"path", "width", "height", "channels", "dtype"}}   in place of an image
///     {"$array": {"shape", "dtype", "summary": {"min", "max", "mean"}}}   of over 64 numbers
///     {"$link": ID}    where the type, or the text itself, says that it is a link
///     {"$more": 12}    at the end of a list of which as many are left out
///
/// Errors: kInvalidArgument as idf::to_json.
Result<nlohmann::ordered_json> shown_value(const idf::Data& value,
                                           const std::optional<idf::Type>& type);

/// A part of a value that a panel can show.
struct ShownMember {
  std::string path;  ///< As Data::at reads it; of an element of an array with "[3]" behind it.
  std::string kind;  ///< "number", "image", "depth", "cloud", "array", "pose", "text" or "link".
  idf::Shape shape{};
  std::optional<idf::Quantity> quantity{};
};

/// The parts of a value in their order. Elements of arrays of up to 4,096 numbers are listed one by
/// one, at most 20,000 parts in all.
[[nodiscard]] std::vector<ShownMember> shown_members(const idf::Data& value,
                                                     const std::optional<idf::Type>& type);

/// The unit of the number at the path of a ShownMember; empty where it is not known.
[[nodiscard]] std::string unit_at(const std::optional<idf::Type>& type, std::string_view path);

/// The number at the path of a ShownMember; NaN where the value has none there.
[[nodiscard]] double number_at(const idf::Data& value, std::string_view path);

/// The image at a path: uint8 [H, W, 1 or 3], uint16 or float32 [H, W, 1]; null where there is
/// none.
[[nodiscard]] const idf::NdArray* image_at(const idf::Data& value, std::string_view path);

}  // namespace engram::reports
