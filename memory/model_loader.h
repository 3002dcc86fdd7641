// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/recall/model.h"

namespace engram {

/// Returns the function that opens the models of a store; null where this was built without
/// LibTorch.
[[nodiscard]] ltm::ModelLoader model_loader();

}  // namespace engram
