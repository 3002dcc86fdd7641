// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// Data sets of LeRobot, v2.0, v2.1 and v3.0; read only. A data set is a folder with
/// meta/info.json, tables, and videos of each camera. Tables are Parquet, read through pyarrow, or
/// CSV beside them. Source: docs/formats.md, section "lerobot".
std::unique_ptr<const RecordingFormat> make_lerobot_format();

}  // namespace engram::datasets
