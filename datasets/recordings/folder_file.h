// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/core/status.h"

namespace engram::datasets {

/// Whether a path is that of a folder or of anything below it, by their names alone. Both are
/// absolute, without links, and do not end in a slash.
[[nodiscard]] bool is_inside(const std::filesystem::path& folder,
                             const std::filesystem::path& path);

/// Finds a file in the folder of a recording by the name that the recording itself gives it. The
/// name is not trusted. Links may point to elsewhere in the folder and, if the folder is
/// `snapshots/<revision>` in the cache of the Hugging Face hub, to the `blobs` of that cache.
/// Errors: kNotFound; kInvalidArgument if the name leads out of the folder or does not name a file.
Result<std::filesystem::path> file_in_folder(const std::filesystem::path& folder,
                                             const std::filesystem::path& name);

}  // namespace engram::datasets
