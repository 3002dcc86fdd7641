// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "ltm/prediction/predictor.h"
#include "ltm/store/latent.h"

namespace engram::ltm {

/// Turns values of one entity into latents and back.
///
/// Threading: one thread.
/// Source: docs/design.md, section 5.
class Encoder {
 public:
  virtual ~Encoder() = default;

  /// One latent per value, in order. The values are consecutive snapshots of one recording and may
  /// be coded as blocks: then latents share their bytes, and their places tell which is which.
  /// Errors: kInvalidArgument where a value has another layout than the model.
  virtual Result<std::vector<Latent>> encode(std::span<const idf::Data> values) = 0;

  /// One value per latent, in order. Exactly what a query answers. Safe on hostile bytes and
  /// places. Any latents of the model, also some of a block; those of one block come in its order,
  /// in this call or in later ones, so that keeping the last block is enough to decode each once.
  /// Errors: kDataLoss where a latent is not of this model.
  virtual Result<std::vector<idf::Data>> decode(std::span<const Latent> latents) = 0;

  /// One code per latent, in order: some numbers, as many for each, whose Euclidean distance is
  /// small where images look alike. Images that are kept as latents are not decoded.
  /// Errors: as decode; kFailedPrecondition where the model has no codes.
  virtual Result<std::vector<std::vector<float>>> global_codes(
      std::span<const Latent> /*latents*/) {
    return failed_precondition("this encoder has no global codes");
  }

  /// The code of a value, to look for what resembles it.
  /// Errors: kInvalidArgument where it has another layout; kFailedPrecondition as above.
  virtual Result<std::vector<float>> global_code(const idf::Data& /*value*/) {
    return failed_precondition("this encoder has no global codes");
  }
};

/// The parts of one model file.
struct LoadedModel {
  std::unique_ptr<Encoder> encoder;
  std::unique_ptr<Predictor> predictor;
  /// Copies the last value, and knows how wrong that was on the same data; may be null.
  std::unique_ptr<Predictor> copy_last = {};
};

/// Opens a model file. Given from above, so that recall needs no learning library.
using ModelLoader = std::function<Result<LoadedModel>(const std::filesystem::path&)>;

}  // namespace engram::ltm
