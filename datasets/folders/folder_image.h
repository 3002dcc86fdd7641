// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: PNG and JPEG files that lie in the folder of a recording.

#include <filesystem>
#include <optional>

#include "ltm/idf/data.h"

namespace engram::datasets {

/// {"image"} of 8 bits or, where `is_depth`, {"depth"} of 16 bits. Nothing where the file is
/// missing, broken, of other bits or not in `folder`.
[[nodiscard]] std::optional<idf::Data> folder_image(const std::filesystem::path& folder,
                                                    const std::filesystem::path& name,
                                                    bool is_depth);

}  // namespace engram::datasets
