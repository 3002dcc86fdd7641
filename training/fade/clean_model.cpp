// SPDX-License-Identifier: Apache-2.0
#include "training/fade/clean_model.h"

#include <utility>

#include "encoders/deep_model_file.h"
#include "training/fit/trainer.h"

namespace engram::training {

Result<std::shared_ptr<encoders::DeepModel>> without_references(const std::filesystem::path& file,
                                                                const std::set<uint64_t>& gone) {
  ENGRAM_ASSIGN_OR_RETURN(auto model, encoders::read_model(file));
  for (auto& references : model->codec.chain.references)
    std::erase_if(references,
                  [&gone](const auto& reference) { return gone.contains(reference.hash()); });
  return model;
}

Result<std::shared_ptr<encoders::DeepModel>> fitted_without_networks(TrainingSource source,
                                                                     const std::stop_token& stop) {
  ENGRAM_CHECK(!source.times.empty(), "nothing to fit a model to");
  if (source.times.size() == 1) {
    // Training needs two values, so it gets one twice.
    source.times.push_back(source.times.front() + Duration(1));
    source.read = [read = source.read](size_t) { return read(0); };
  }
  TrainOptions options;
  options.has_networks = false;
  options.number_bound = 0;
  options.budget = std::chrono::seconds(1);
  // Predictions are measured on some of them.
  options.memory_bytes = uint64_t{32} << 20;
  ENGRAM_ASSIGN_OR_RETURN(FittedModel fitted, fit_model(source, options, {}, stop));
  return std::move(fitted.model);
}

}  // namespace engram::training
