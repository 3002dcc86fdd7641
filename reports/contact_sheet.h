// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ltm/idf/data.h"

namespace engram::reports {

/// The factor by which differences are amplified.
inline constexpr int kDifferenceGain = 8;

/// Returns the first 8-bit colour or grey image of a value, or null if there is none.
[[nodiscard]] const idf::NdArray* first_image(const idf::Data& data);

/// Returns the amplified difference of two images of the same size.
[[nodiscard]] idf::NdArray difference(const idf::NdArray& a, const idf::NdArray& b);

/// One row of a contact sheet. Images are uint8 [H, W, 3] or [H, W, 1], all of the same size.
struct PictureRow {
  std::string label;  ///< One or more lines of text.
  std::vector<idf::NdArray> images;
};

/// Writes labelled rows of images as one PNG, with `column_labels` above the columns. Images that
/// are too small to tell apart are magnified.
/// Errors: kInvalidArgument if sizes differ or there are no images; kUnavailable.
Status write_contact_sheet(const std::filesystem::path& path, const std::vector<PictureRow>& rows,
                           const std::vector<std::string>& column_labels);

}  // namespace engram::reports
