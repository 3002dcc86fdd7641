// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "encoders/deep_model.h"
#include "ltm/store/store_reader.h"
#include "training/fade/gist_quality.h"
#include "training/forms/block_choice.h"

// Private to this room: includes LibTorch.

namespace engram::training {

/// Reads the model that made the latents of a version.
/// Errors: kDataLoss if the store does not have it; those of reading.
Result<std::shared_ptr<encoders::DeepModel>> model_of_version(const ltm::StoreReader& reader,
                                                              const ltm::MemoryId& entity,
                                                              int version);

/// A model of an entity, and what codes stored values anew with it.
///
/// Threading: one thread, which starts others for videos.
struct EntityCoder {
  EntityCoder(int its_version, std::shared_ptr<encoders::DeepModel> its_model);

  /// Codes consecutive values as blocks of which every image is within `max_mse` of its value. The
  /// bound is rounded up a little, so that groups of about equal quality share what is learned
  /// about their videos. Errors: those of BlockChoice::encode.
  Result<std::vector<ltm::Latent>> encode(std::span<const idf::Data> values, double max_mse,
                                          const std::stop_token& stop);

  int version = 0;
  std::shared_ptr<encoders::DeepModel> model;
  std::unique_ptr<ltm::Encoder> decoder;
  GistQuality gist;

 private:
  BlockChoice& choice(double bound_db);

  /// By the bound in multiples of its step. Each learns how quality follows from crf.
  std::map<int, std::unique_ptr<BlockChoice>> of_bound_;
};

}  // namespace engram::training
