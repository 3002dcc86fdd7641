// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "datasets/scenes/scene_source.h"

namespace engram::cli {

/// What rebuilds remembered moments: those of simulated kitchens.
/// Errors: kFailedPrecondition where the program is built without.
Result<std::unique_ptr<datasets::SceneSource>> make_scene_source();

}  // namespace engram::cli
