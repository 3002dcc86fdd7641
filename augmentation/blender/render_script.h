// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace engram::augmentation {

/// render_scenes.py, which Blender runs.
[[nodiscard]] std::string_view render_script();

}  // namespace engram::augmentation
