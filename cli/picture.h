// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::cli {

/// One row of a contact sheet. Images are uint8 [H, W, 3] or [H, W, 1], all of the same size.
struct PictureRow {
  std::string label;
  std::vector<idf::NdArray> images;
};

/// Writes labelled rows of images as one PNG; columns are headed by `column_labels`.
/// Errors: kInvalidArgument where sizes differ or there are none; kUnavailable.
Status write_contact_sheet(const std::filesystem::path& path, const std::vector<PictureRow>& rows,
                           const std::vector<std::string>& column_labels);

}  // namespace engram::cli
