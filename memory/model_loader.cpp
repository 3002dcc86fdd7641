// SPDX-License-Identifier: Apache-2.0
#include "memory/model_loader.h"

#include "encoders/load_model.h"

namespace engram {

ltm::ModelLoader model_loader() {
  return encoders::load_model;
}

}  // namespace engram
