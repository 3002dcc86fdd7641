// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/recall/model.h"

namespace engram {

/// What opens the models of a store: null where this was built without learning.
[[nodiscard]] ltm::ModelLoader model_loader();

}  // namespace engram
