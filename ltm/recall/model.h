// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ltm/prediction/predictor.h"
#include "ltm/store/latent.h"

namespace engram::ltm {

/// Encodes values of one entity as latents and decodes them.
///
/// Threading: one thread.
/// Source: docs/design.md, section 5.
class Encoder {
 public:
  virtual ~Encoder() = default;

  /// Returns one latent per value, in order. The values are consecutive snapshots of one recording
  /// and may be coded as blocks: then several latents share their bytes and differ in their places.
  /// Errors: kInvalidArgument if a value has another layout than the model.
  virtual Result<std::vector<Latent>> encode(std::span<const idf::Data> values) = 0;

  /// Returns one value per latent, in order: exactly what a query answers. Safe on hostile bytes
  /// and places. It takes any latents of the model, also a part of a block. Callers pass the
  /// latents of one block in its order, in this call or in later ones, so an encoder that keeps
  /// the last block decodes each block once.
  /// Errors: kDataLoss if a latent is not of this model.
  virtual Result<std::vector<idf::Data>> decode(std::span<const Latent> latents) = 0;

  /// Returns one code per latent, in order. All codes have the same number of elements, and their
  /// Euclidean distance is small if the images look alike. Images that are kept as latents are not
  /// decoded for it.
  /// Errors: as decode; kFailedPrecondition if the model has no codes.
  virtual Result<std::vector<std::vector<float>>> global_codes(
      std::span<const Latent> /*latents*/) {
    return failed_precondition("this encoder has no global codes");
  }

  /// Returns the code of a value, to search for similar ones.
  /// Errors: kInvalidArgument if it has another layout; kFailedPrecondition as above.
  virtual Result<std::vector<float>> global_code(const idf::Data& /*value*/) {
    return failed_precondition("this encoder has no global codes");
  }
};

/// The parts of one model file.
struct LoadedModel {
  std::unique_ptr<Encoder> encoder;
  std::unique_ptr<Predictor> predictor;
  /// Copies the last value; its errors were measured on the same data. May be null.
  std::unique_ptr<Predictor> copy_last = {};
  /// The time of the last snapshot that it was trained on or measured with; empty: not known.
  std::optional<Time> trained_until = {};
};

/// Opens a model file. The caller of recall provides it, so that recall needs no learning library.
using ModelLoader = std::function<Result<LoadedModel>(const std::filesystem::path&)>;

}  // namespace engram::ltm
