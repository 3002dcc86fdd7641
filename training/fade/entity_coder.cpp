// SPDX-License-Identifier: Apache-2.0
#include "training/fade/entity_coder.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <thread>
#include <utility>

#include "encoders/deep_model_file.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

/// Bounds of videos are multiples of this. Unit: dB.
constexpr double kBoundStep = 0.25;

}  // namespace

Result<std::shared_ptr<encoders::DeepModel>> model_of_version(const ltm::StoreReader& reader,
                                                              const ltm::MemoryId& entity,
                                                              int version) {
  for (const ltm::ModelInfo& info : reader.manifest().models)
    if (info.entity == entity && info.version == version)
      return encoders::read_model(reader.path() / info.file);
  return data_loss("{}: latents of model v{}, which is missing", entity.to_string(), version);
}

EntityCoder::EntityCoder(int its_version, std::shared_ptr<encoders::DeepModel> its_model)
    : version(its_version), model(std::move(its_model)), decoder(encoders::make_encoder(model)) {}

BlockChoice& EntityCoder::choice(double bound_db) {
  const int key = static_cast<int>(std::ceil(bound_db / kBoundStep));
  auto& found = of_bound_[key];
  if (found) return *found;
  RepresentationOptions options;
  options.kind = Representation::kAuto;
  options.bound_db = key * kBoundStep;
  options.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  found = std::make_unique<BlockChoice>(*model, options);
  return *found;
}

Result<std::vector<ltm::Latent>> EntityCoder::encode(std::span<const idf::Data> values,
                                                     double max_mse, const std::stop_token& stop) {
  BlockChoice& choice_of = choice(psnr_db(max_mse));
  std::vector<ltm::Latent> latents;
  const size_t max_rows = model->block_rows();
  for (auto rest = values; !rest.empty();) {
    const auto block = rest.first(std::min(max_rows, rest.size()));
    ENGRAM_ASSIGN_OR_RETURN(auto coded, choice_of.encode(block, stop));
    std::ranges::move(coded, std::back_inserter(latents));
    rest = rest.subspan(block.size());
  }
  return latents;
}

}  // namespace engram::training
