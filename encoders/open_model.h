// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "encoders/coding/latent_grid.h"
#include "encoders/provenance.h"
#include "ltm/idf/layout.h"
#include "ltm/recall/model.h"

namespace engram::encoders {

/// The latents of one image member: rounded integers, the coarse ones first, then the fine ones.
struct LatentMember {
  std::string path;   ///< In the value; empty: the value itself.
  LatentGrid coarse;  ///< A place is 16 x 16 pixels, more for large images.
  LatentGrid fine;    ///< Half of that.

  [[nodiscard]] size_t count() const { return coarse.count() + fine.count(); }
};

/// Latents of values as arrays: what plots and experiments work on. N values, K numbers of each.
struct LatentArrays {
  std::vector<uint32_t> scenes;              ///< Background of each value. [N]
  std::vector<std::vector<int32_t>> images;  ///< Per image member [N, LatentMember::count()].
  /// Per image member whether a value is kept as latents there. [N] Where not, they are zero.
  std::vector<std::vector<bool>> is_latent;
  std::vector<double> numbers;        ///< [N, K]
  std::vector<idf::List> remainders;  ///< What cannot be a tensor, as it was. [N]
};

/// A tensor of a model by its name: weights, biases, backgrounds.
struct NamedWeights {
  std::string name;
  idf::NdArray values;  ///< float32
};

/// A model file that is looked into.
///
/// Threading: one thread.
class OpenModel {
 public:
  /// Errors: those of load_model.
  static Result<OpenModel> open(const std::filesystem::path& path);

  OpenModel(OpenModel&&) noexcept;
  ~OpenModel();

  [[nodiscard]] const Provenance& provenance() const;
  [[nodiscard]] const idf::Layout& layout() const;
  /// Image members that have latents: none where the model has no networks.
  [[nodiscard]] const std::vector<LatentMember>& images() const;
  /// Paths of the members whose numbers are LatentArrays::numbers, each as often as it has some.
  [[nodiscard]] std::vector<std::string> numbers() const;

  /// Each value alone, all on the one background that suits them best: they should be of one
  /// recording.
  /// Errors: kInvalidArgument where a value has another layout.
  Result<LatentArrays> encode(std::span<const idf::Data> values);

  /// The images of latents are those of the networks: residuals are no part of them.
  /// Errors: kInvalidArgument where the arrays are not of this model; kFailedPrecondition where it
  /// has images and no networks.
  Result<std::vector<idf::Data>> decode(const LatentArrays& latents);

  /// What latents of a store hold, without decoding images. Errors: kDataLoss.
  Result<LatentArrays> stored(std::span<const ltm::Latent> latents);

  /// As Encoder::global_code, of each.
  Result<std::vector<std::vector<float>>> global_codes(std::span<const idf::Data> values);

  /// See Predictor.
  [[nodiscard]] ltm::Predictor& predictor();

  /// All weights, in the order of their names.
  [[nodiscard]] std::vector<NamedWeights> weights() const;

 private:
  struct State;
  explicit OpenModel(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::encoders
