// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// "tum": folders of the TUM RGB-D benchmark; read and written.
/// Source: docs/formats.md.
[[nodiscard]] std::unique_ptr<const RecordingFormat> make_tum_format();

/// "7scenes": scenes of the 7-Scenes data set, or sequences of them; read only.
/// Source: docs/formats.md.
[[nodiscard]] std::unique_ptr<const RecordingFormat> make_seven_scenes_format();

/// "images": a folder of images and one table with their times; read only.
/// Source: docs/formats.md.
[[nodiscard]] std::unique_ptr<const RecordingFormat> make_images_format();

/// "euroc": folders of the EuRoC MAV data set; read only.
/// Source: docs/formats.md.
[[nodiscard]] std::unique_ptr<const RecordingFormat> make_euroc_format();

}  // namespace engram::datasets
