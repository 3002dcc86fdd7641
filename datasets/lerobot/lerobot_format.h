// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// Data sets of LeRobot, v2.0 and v2.1, read: a folder with meta/info.json, a table and a video per
/// camera for each episode. Tables are Parquet, read through pyarrow, or CSV beside them.
/// Source: docs/formats.md, section "lerobot".
std::unique_ptr<const RecordingFormat> make_lerobot_format();

}  // namespace engram::datasets
