// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "datasets/scenes/scene_source.h"

namespace engram::cli {

/// Makes the source that rebuilds remembered moments of simulated kitchens.
/// Errors: kFailedPrecondition if the program is built without the kitchen.
Result<std::unique_ptr<datasets::SceneSource>> make_scene_source();

}  // namespace engram::cli
