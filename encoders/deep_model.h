// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "encoders/condition.h"
#include "encoders/dynamics.h"
#include "encoders/global_code.h"
#include "encoders/latent_block.h"
#include "encoders/prediction_record.h"
#include "encoders/provenance.h"
#include "encoders/tensor_plan.h"
#include "ltm/core/time.h"
#include "ltm/recall/model.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// Everything that a model file holds.
///
/// Threading: one thread.
struct DeepModel {
  /// Freshly initialised networks. Uses LibTorch's random generator.
  DeepModel(TensorPlan plan, const NetworkSizes& sizes);

  TensorPlan plan;
  std::vector<double> mean;       ///< Per number.
  std::vector<double> deviation;  ///< Per number; 0 where it never changed.
  Autoencoder autoencoder;
  Dynamics dynamics;
  GlobalCode global_code;
  LatentBlockCodec codec;
  std::optional<Condition> condition;
  PredictionRecord prediction;     ///< With conditions, where there are any.
  PredictionRecord planned;        ///< With conditions, and what is planned of them.
  PredictionRecord unconditioned;  ///< Where they are not known.
  PredictionRecord copied;         ///< Of copies of the last value.
  Provenance provenance;

  /// Numbers in units of their deviation from the mean; 0 for those that are not finite.
  [[nodiscard]] std::vector<float> normalise(std::span<const double> numbers) const;

  /// The images of one value in grey levels, padded, and its numbers, normalised. Batch of one, of
  /// scene 0.
  /// Errors: kInvalidArgument where the value has another layout.
  Result<Parts> to_parts(const idf::SplitValue& value) const;

  /// The images of a batch of one as arrays.
  [[nodiscard]] std::vector<idf::NdArray> to_arrays(const Parts& parts) const;

  /// One array per image member and all numbers, as a value.
  Result<idf::Data> to_value(std::vector<idf::NdArray> images, std::span<const double> numbers,
                             const idf::List& remainder) const;

  /// What numbers become that change as `then` differs from `last`, both of a batch of one. Those
  /// that never changed in training stay what they are.
  /// Shape: numbers [plan.number_count()].
  [[nodiscard]] std::vector<double> moved_numbers(std::vector<double> numbers, const Parts& last,
                                                  const Parts& then) const;

  /// Mean squared differences of two batches of one, without what is padded, as training::compare
  /// counts them.
  [[nodiscard]] ltm::MeasuredError difference(const Parts& a, const Parts& b) const;

  /// Rounded latents of one image of a batch of one: coarse, then fine.
  [[nodiscard]] static std::vector<int32_t> to_integers(const ImageLatents& latents);

  /// One row as a batch of one.
  [[nodiscard]] Latents to_latents(const LatentRows& rows, size_t row) const;

  /// Consecutive values of one recording as rows: images as latents, on backgrounds of their `own`
  /// where there are any. Without networks they have none, and need another form before they can
  /// be coded.
  Result<LatentRows> to_rows(std::span<const idf::SplitValue> values,
                             std::vector<CodedBackground> own = {});

  /// Backgrounds of a block as the networks see them, per image member [1, C, H, W]; none where it
  /// has none of its own. Unit: grey levels.
  [[nodiscard]] std::vector<torch::Tensor> backgrounds_of(const LatentRows& rows) const;

  /// The scene that rows of one recording are reconstructed best with: [1] of int64.
  [[nodiscard]] torch::Tensor best_scene(std::span<const Parts> parts);

  /// Most rows that are coded as one block: as many chains as it may have, but no more than 64 MB
  /// of images, and one chain at least.
  [[nodiscard]] size_t block_rows() const;

  /// Codes consecutive values of one recording as one block: images as latents, or, without
  /// networks, as videos of usual quality.
  /// Errors: kInvalidArgument where an image is too small for a video.
  Result<std::vector<ltm::Latent>> encode(std::span<const idf::Data> values);

  /// The images of a row, one per member, with their residuals.
  Result<std::vector<idf::NdArray>> decode_images(const LatentRows& rows, size_t row);
  Result<idf::Data> decode(const LatentRows& rows, size_t row, const idf::List& remainder);

  /// The global code of a value, kGlobalCodeSize numbers: alike where images look alike.
  /// Errors: kInvalidArgument where it has another layout; kFailedPrecondition where the model has
  /// no global code: without networks, or of an older file.
  Result<std::vector<float>> global_code_of(const idf::Data& value);
  /// That of a row. Images are decoded only where they are not kept as latents.
  Result<std::vector<float>> global_code_of(const LatentRows& rows, size_t row,
                                            const idf::List& remainder);

 private:
  [[nodiscard]] Status check_global_code() const;
  Status add_videos(std::span<const idf::SplitValue> values, LatentRows& rows) const;
  void add_latents(std::vector<Parts> parts, LatentRows& rows);
  double reconstruction_error(Parts values, const torch::Tensor& scene);
};

/// Pixels [B, H, W, C] as they lie in memory -> [B, C, H, W] in grey levels, padded by repeating
/// the edge.
[[nodiscard]] torch::Tensor to_grey_levels(const ImageMember& image, const ImageShape& shape,
                                           const torch::Tensor& pixels);

/// The image of a batch of one [1, C, H, W], in grey levels, as an array of the member's type,
/// without what it was padded with.
[[nodiscard]] idf::NdArray to_image_array(const ImageMember& image, const torch::Tensor& batch);

/// The latents of a block: one per split value, whose remainders they take.
[[nodiscard]] std::vector<ltm::Latent> latents_of(std::vector<std::byte> block,
                                                  std::vector<idf::SplitValue> values);

/// What training and queries both see of a model.
[[nodiscard]] std::unique_ptr<ltm::Encoder> make_encoder(std::shared_ptr<DeepModel> model);
[[nodiscard]] std::unique_ptr<ltm::Predictor> make_predictor(std::shared_ptr<DeepModel> model);
/// Copies the last value, whatever its layout; of the model's it knows how wrong that is.
[[nodiscard]] std::unique_ptr<ltm::Predictor> make_copies(std::shared_ptr<DeepModel> model);

/// Shares of a prediction.
struct BlendShares {
  double latents = 0;  ///< Of images.
  double motion = 0;   ///< Of images.
  double numbers = 0;
};

/// What is expected of one moment.
struct Future {
  Parts latents;                      ///< As the latents have it.
  std::vector<torch::Tensor> motion;  ///< Images as their motion has them.
};

/// What is needed of one moment ahead: a closed gate needs nothing of what it lets through.
struct FutureNeed {
  int step = 1;
  bool latents = true;
  bool motion = true;
};

/// What is needed after each of some steps, in their order (ascending, each once): one rollout
/// serves them all. What is not needed is left empty.
[[nodiscard]] std::vector<Future> futures_of(DeepModel& model, const Parts& last,
                                             const Parts& before,
                                             std::span<const FutureNeed> needs);

/// The futures of 1..`steps` steps after `last`, whose latents are made on the way.
[[nodiscard]] std::vector<Future> futures_of(DeepModel& model, const Parts& last,
                                             const Parts& before, int steps);

/// The last value, plus the shares of how expectations differ from it.
[[nodiscard]] Parts mix(const Parts& last, const Future& future, const BlendShares& shares);

}  // namespace engram::encoders
