// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace engram::augmentation {

/// Returns the text of render_scenes.py, which Blender runs.
[[nodiscard]] std::string_view render_script();

}  // namespace engram::augmentation
