// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: PNG and JPEG files in the folder of a recording.

#include <filesystem>
#include <optional>

#include "ltm/idf/data.h"

namespace engram::datasets {

/// Reads {"image"} with 8 bits or, if `is_depth` is true, {"depth"} with 16 bits. Returns nothing
/// if the file is missing, broken, has other bits or is not in `folder`.
[[nodiscard]] std::optional<idf::Data> folder_image(const std::filesystem::path& folder,
                                                    const std::filesystem::path& name,
                                                    bool is_depth);

}  // namespace engram::datasets
