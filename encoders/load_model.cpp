// SPDX-License-Identifier: Apache-2.0
#include "encoders/load_model.h"

#include "encoders/deep_model_file.h"

namespace engram::encoders {

Result<ltm::LoadedModel> load_model(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const std::shared_ptr<DeepModel> model, read_model(path));
  return ltm::LoadedModel{make_encoder(model), make_predictor(model), make_copies(model)};
}

}  // namespace engram::encoders
