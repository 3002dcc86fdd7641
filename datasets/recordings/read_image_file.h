// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/idf/ndarray.h"

namespace engram::datasets {

/// Reads the pixels of a PNG file (grey of 8 or 16 bits, RGB of 8) or a JPEG file (grey, RGB). The
/// image may have at most 256 MiB of pixels.
/// Shape: uint8 [H, W, 3] or [H, W, 1], uint16 [H, W, 1].
/// Errors: kNotFound, kUnavailable; kInvalidArgument naming the file if it is of another kind;
/// kDataLoss if it is broken.
Result<idf::NdArray> read_image_file(const std::filesystem::path& path);

/// Returns true if a name ends in ".png", ".jpg" or ".jpeg", in upper or lower case.
[[nodiscard]] bool has_image_name(const std::filesystem::path& path);

}  // namespace engram::datasets
