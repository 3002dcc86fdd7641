// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// "robomimic": demonstrations of robomimic and LIBERO; one file with a group for each.
/// Source: docs/formats.md.
[[nodiscard]] std::unique_ptr<const RecordingFormat> make_robomimic_format();

/// "aloha": episodes of ALOHA; a file for each, alone or in a folder.
/// Source: docs/formats.md.
[[nodiscard]] std::unique_ptr<const RecordingFormat> make_aloha_format();

}  // namespace engram::datasets
