// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// "tum": folders of the TUM RGB-D benchmark; read only.
/// Source: docs/formats.md.
[[nodiscard]] std::unique_ptr<const RecordingFormat> make_tum_format();

}  // namespace engram::datasets
