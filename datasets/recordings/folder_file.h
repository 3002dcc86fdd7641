// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/core/status.h"

namespace engram::datasets {

/// A file in the folder of a recording, by the name that the recording itself gives it: nobody
/// knows who wrote that name. Links may lead to elsewhere in the folder and, of a folder
/// `snapshots/<revision>` in the cache of the Hugging Face hub, to its `blobs`.
/// Errors: kNotFound; kInvalidArgument where the name leads out of the folder, or to what is no
/// file.
Result<std::filesystem::path> file_in_folder(const std::filesystem::path& folder,
                                             const std::filesystem::path& name);

}  // namespace engram::datasets
