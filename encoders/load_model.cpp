// SPDX-License-Identifier: Apache-2.0
#include "encoders/load_model.h"

#include <algorithm>

#include "encoders/deep_model_file.h"

namespace engram::encoders {

namespace {

/// What is held out lies within the recordings that the autoencoder was trained on.
std::optional<Time> trained_until(const Provenance& from) {
  std::optional<Time> until;
  for (const auto* spans : {&from.autoencoder_spans, &from.dynamics_spans})
    for (const TimeSpan& span : *spans) until = std::max(until.value_or(span.last), span.last);
  return until;
}

}  // namespace

Result<ltm::LoadedModel> load_model(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const std::shared_ptr<DeepModel> model, read_model(path));
  return ltm::LoadedModel{make_encoder(model), make_predictor(model), make_copies(model),
                          trained_until(model->provenance)};
}

}  // namespace engram::encoders
