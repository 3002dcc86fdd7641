// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/idf/ndarray.h"

namespace engram::datasets {

/// The pixels of a PNG file (grey of 8 or 16 bits, RGB of 8) or a JPEG file (grey, RGB). At most
/// 256 MiB of them.
/// Shape: uint8 [H, W, 3] or [H, W, 1], uint16 [H, W, 1].
/// Errors: kNotFound, kUnavailable; kInvalidArgument naming the file where it is of another kind;
/// kDataLoss where it is broken.
Result<idf::NdArray> read_image_file(const std::filesystem::path& path);

/// Whether a name ends as those of such files do: ".png", ".jpg", ".jpeg", in any case.
[[nodiscard]] bool has_image_name(const std::filesystem::path& path);

}  // namespace engram::datasets
