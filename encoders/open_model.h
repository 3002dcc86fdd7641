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
  std::string path;   ///< Path in the value; empty for the value itself.
  LatentGrid coarse;  ///< A cell is 16 x 16 pixels, or more for large images.
  LatentGrid fine;    ///< A cell has half of that side.
  int channels = 0;   ///< Of the image.

  [[nodiscard]] size_t count() const { return coarse.count() + fine.count(); }
};

/// Latents of N values with K numbers each as arrays, for plots and experiments.
struct LatentArrays {
  std::vector<uint32_t> scenes;              ///< Background of each value. [N]
  std::vector<std::vector<int32_t>> images;  ///< Per image member [N, LatentMember::count()].
  /// Per image member [N]: whether a value is kept as latents. If not, its latents are zero.
  std::vector<std::vector<bool>> is_latent;
  /// Per image member [N]: the background that the block of a value carries itself, uint8
  /// [H, W, C]; without elements: it is seen on that of its scene. decode() takes scenes alone.
  std::vector<std::vector<idf::NdArray>> own;
  std::vector<double> numbers;        ///< [N, K]
  std::vector<idf::List> remainders;  ///< Parts that cannot be a tensor, unchanged. [N]
};

/// A named tensor of a model: weights, biases or backgrounds.
struct NamedWeights {
  std::string name;
  idf::NdArray values;  ///< float32
};

/// An open model file, for inspection and experiments.
///
/// Threading: one thread.
class OpenModel {
 public:
  /// Errors: the errors of load_model.
  static Result<OpenModel> open(const std::filesystem::path& path);

  OpenModel(OpenModel&&) noexcept;
  ~OpenModel();

  [[nodiscard]] const Provenance& provenance() const;
  [[nodiscard]] const idf::Layout& layout() const;
  /// Image members that have latents; empty if the model has no networks.
  [[nodiscard]] const std::vector<LatentMember>& images() const;
  /// The path of the member of each number in LatentArrays::numbers.
  [[nodiscard]] std::vector<std::string> numbers() const;

  /// Encodes each value alone, all with the one background that fits them best. The values should
  /// be of one recording.
  /// Errors: kInvalidArgument if a value has another layout.
  Result<LatentArrays> encode(std::span<const idf::Data> values);

  /// Decodes latents. Residuals are not applied: images are the output of the networks alone.
  /// Errors: kInvalidArgument if the arrays do not fit this model; kFailedPrecondition if it has
  /// images and no networks.
  Result<std::vector<idf::Data>> decode(const LatentArrays& latents);

  /// Reads the latents that a store holds, without decoding images.
  /// Errors: kDataLoss.
  Result<LatentArrays> stored(std::span<const ltm::Latent> latents);

  /// The background to which the latents of an image tell the difference. Most of what stands still
  /// in a recording is there.
  /// Shape: float32 [C, H, W], padded to whole cells. Unit: grey levels.
  [[nodiscard]] idf::NdArray background(const LatentArrays& latents, size_t image,
                                        size_t value) const;

  /// Returns the result of Encoder::global_code for each value.
  Result<std::vector<std::vector<float>>> global_codes(std::span<const idf::Data> values);

  /// The model's predictor. It lives as long as this object.
  [[nodiscard]] ltm::Predictor& predictor();

  /// All weights, sorted by name.
  [[nodiscard]] std::vector<NamedWeights> weights() const;

 private:
  struct State;
  explicit OpenModel(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::encoders
