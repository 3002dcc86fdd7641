// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: folders of the EuRoC MAV data set.

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// Returns true if a folder, or the folder mav0 in it, has cam0/data.csv or imu0/data.csv.
[[nodiscard]] bool is_euroc_folder(const std::filesystem::path& folder);

/// Errors: kInvalidArgument if there is no table of a sensor, or one has other columns.
Result<std::unique_ptr<RecordingReader>> open_euroc_folder(const std::filesystem::path& folder,
                                                           const ReadingOptions& options);

}  // namespace engram::datasets
