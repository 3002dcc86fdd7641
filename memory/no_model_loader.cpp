// SPDX-License-Identifier: Apache-2.0
// Replaces model_loader.cpp where there is no LibTorch.
#include "memory/model_loader.h"

namespace engram {

ltm::ModelLoader model_loader() {
  return {};
}

}  // namespace engram
