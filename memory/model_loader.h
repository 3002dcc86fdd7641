// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/recall/model.h"

namespace engram {

/// Returns the function that opens the models of a store; null where this was built without
/// LibTorch. In a library it is linked with LibTorch; the program `engram` has another definition,
/// which loads LibTorch when it is called first (cli/learning_module.h).
[[nodiscard]] ltm::ModelLoader model_loader();

}  // namespace engram
