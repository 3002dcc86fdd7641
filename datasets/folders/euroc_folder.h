// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: folders of the EuRoC MAV data set.

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// Whether a folder, or the folder mav0 in it, has cam0/data.csv or imu0/data.csv.
[[nodiscard]] bool is_euroc_folder(const std::filesystem::path& folder);

/// Errors: kInvalidArgument where no sensor's table is there, or one has other columns.
Result<std::unique_ptr<RecordingReader>> open_euroc_folder(const std::filesystem::path& folder,
                                                           const ReadingOptions& options);

}  // namespace engram::datasets
