// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ltm/idf/data.h"

namespace engram::reports {

/// What differences are amplified by.
inline constexpr int kDifferenceGain = 8;

/// The first colour or grey image of 8 bits in a value; null where there is none.
[[nodiscard]] const idf::NdArray* first_image(const idf::Data& data);

/// Where two images of the same size differ, amplified.
[[nodiscard]] idf::NdArray difference(const idf::NdArray& a, const idf::NdArray& b);

/// One row of a contact sheet. Images are uint8 [H, W, 3] or [H, W, 1], all of the same size.
struct PictureRow {
  std::string label;  ///< A line of text, or several.
  std::vector<idf::NdArray> images;
};

/// Writes labelled rows of images as one PNG; columns are headed by `column_labels`. Images that
/// are too small to be told apart are magnified. Errors: kInvalidArgument where sizes differ or
/// there are none; kUnavailable.
Status write_contact_sheet(const std::filesystem::path& path, const std::vector<PictureRow>& rows,
                           const std::vector<std::string>& column_labels);

}  // namespace engram::reports
