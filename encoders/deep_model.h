// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "encoders/condition.h"
#include "encoders/dynamics.h"
#include "encoders/gist_video.h"
#include "encoders/global_code.h"
#include "encoders/latent_block.h"
#include "encoders/prediction_record.h"
#include "encoders/provenance.h"
#include "encoders/tensor_plan.h"
#include "ltm/core/time.h"
#include "ltm/recall/model.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// The content of a model file.
///
/// Threading: one thread.
struct DeepModel {
  /// Freshly initialised networks. Uses LibTorch's random generator.
  DeepModel(TensorPlan plan, const NetworkSizes& sizes);

  TensorPlan plan;
  std::vector<double> mean;       ///< Per number.
  std::vector<double> deviation;  ///< Per number; 0 if it never changed.
  Autoencoder autoencoder;
  Dynamics dynamics;
  GlobalCode global_code;
  LatentBlockCodec codec;
  std::optional<Condition> condition;
  PredictionRecord prediction;     ///< Measured with conditions, if the model has any.
  PredictionRecord planned;        ///< Measured with conditions and their plan.
  PredictionRecord unconditioned;  ///< Measured without conditions.
  PredictionRecord copied;         ///< Measured for copies of the last value.
  Provenance provenance;

  /// Returns numbers minus their means, in units of their standard deviations; numbers that are not
  /// finite become 0.
  [[nodiscard]] std::vector<float> normalise(std::span<const double> numbers) const;

  /// Returns the images of one value in grey levels, padded, and its normalised numbers, as a batch
  /// of one with scene 0.
  /// Errors: kInvalidArgument if the value has another layout.
  Result<Parts> to_parts(const idf::SplitValue& value) const;

  /// Returns the images of a batch of one as arrays.
  [[nodiscard]] std::vector<idf::NdArray> to_arrays(const Parts& parts) const;

  /// Assembles a value from one array per image member, all numbers and the remainder.
  Result<idf::Data> to_value(std::vector<idf::NdArray> images, std::span<const double> numbers,
                             const idf::List& remainder) const;

  /// Adds to `numbers` the difference between `then` and `last`, each a batch of one. Numbers that
  /// never changed in training stay as they are.
  /// Shape: numbers [plan.number_count()].
  [[nodiscard]] std::vector<double> moved_numbers(std::vector<double> numbers, const Parts& last,
                                                  const Parts& then) const;

  /// Mean squared differences of two batches of one, without the padding, computed as in
  /// training::compare.
  [[nodiscard]] ltm::MeasuredError difference(const Parts& a, const Parts& b) const;

  /// Rounds the latents of one image of a batch of one: first the coarse ones, then the fine ones.
  [[nodiscard]] static std::vector<int32_t> to_integers(const ImageLatents& latents);

  /// Returns one row as a batch of one.
  [[nodiscard]] Latents to_latents(const LatentRows& rows, size_t row) const;

  /// Turns consecutive values of one recording into rows. Images become latents on the backgrounds
  /// in `own`, or on the best background of the model if `own` is empty. A model without networks
  /// makes no latents, so its images need another form before they can be coded.
  Result<LatentRows> to_rows(std::span<const idf::SplitValue> values,
                             std::vector<CodedBackground> own = {});

  /// Backgrounds that a block carries, as input of the networks, per image member; empty if it
  /// carries none.
  /// Shape: [1, C, H, W].
  /// Unit: grey levels.
  [[nodiscard]] std::vector<torch::Tensor> backgrounds_of(const LatentRows& rows) const;

  /// Finds the scene with the best reconstruction of rows of one recording.
  /// Shape: int64 [1].
  [[nodiscard]] torch::Tensor best_scene(std::span<const Parts> parts);

  /// Maximum number of rows of which all images are in memory: 64 MB of images, at least one row
  /// and at most kMaxBlockRows.
  [[nodiscard]] size_t max_rows() const;

  /// Maximum number of rows of one block: kMaxChains chains, but no more than max_rows(), and at
  /// least one chain.
  [[nodiscard]] size_t block_rows() const;

  /// Codes consecutive values of one recording as one block. Images are kept as latents or, without
  /// networks, as videos of default quality.
  /// Errors: kInvalidArgument if an image is too small for a video.
  Result<std::vector<ltm::Latent>> encode(std::span<const idf::Data> values);
  /// The same of values that were split by `plan`.
  Result<std::vector<ltm::Latent>> encode(std::vector<idf::SplitValue> split);

  /// Codes consecutive values as one block of one chain. Of 8-bit images that a gist takes
  /// (gist_video.h) the gist is kept, of others a video as by encode().
  /// Errors: kInvalidArgument if a value has another layout or there are more than kMaxBlockRows;
  /// those of encode_gist.
  Result<std::vector<ltm::Latent>> encode_as_gist(std::span<const idf::Data> values,
                                                  const GistOptions& options) const;

  /// Decodes the images of a row, one per member, and adds their residuals.
  Result<std::vector<idf::NdArray>> decode_images(const LatentRows& rows, size_t row);
  Result<idf::Data> decode(const LatentRows& rows, size_t row, const idf::List& remainder);

  /// Returns the global code of a value: kGlobalCodeSize numbers that are similar for images that
  /// look similar.
  /// Errors: kInvalidArgument if the value has another layout; kFailedPrecondition if the model has
  /// no global code because it has no networks or its file is older.
  Result<std::vector<float>> global_code_of(const idf::Data& value);
  /// Returns the global code of a row. Images are decoded only if they are not kept as latents.
  Result<std::vector<float>> global_code_of(const LatentRows& rows, size_t row,
                                            const idf::List& remainder);

 private:
  [[nodiscard]] Status check_global_code() const;
  Status add_video(size_t image, std::span<const idf::NdArray> images, LatentRows& rows) const;
  Status add_videos(std::span<const idf::SplitValue> values, LatentRows& rows) const;
  /// The images of a member.
  [[nodiscard]] std::vector<idf::NdArray> images_of(size_t image,
                                                    std::span<const idf::SplitValue> values) const;
  void add_latents(std::vector<Parts> parts, LatentRows& rows);
  double reconstruction_error(Parts values, const torch::Tensor& scene);
};

/// Converts pixels from memory order to grey levels and pads them by repeating the edge.
/// Shape: [B, H, W, C] -> [B, C, H, W].
[[nodiscard]] torch::Tensor to_grey_levels(const ImageMember& image, const ImageShape& shape,
                                           const torch::Tensor& pixels);

/// Converts a batch of one [1, C, H, W], in grey levels, to an array of the member's type without
/// the padding.
[[nodiscard]] idf::NdArray to_image_array(const ImageMember& image, const torch::Tensor& batch);

/// Makes the latents of a block: one per split value, with the remainder of that value.
[[nodiscard]] std::vector<ltm::Latent> latents_of(std::vector<std::byte> block,
                                                  std::vector<idf::SplitValue> values);

/// The interfaces through which both training and queries use a model.
[[nodiscard]] std::unique_ptr<ltm::Encoder> make_encoder(std::shared_ptr<DeepModel> model);
[[nodiscard]] std::unique_ptr<ltm::Predictor> make_predictor(std::shared_ptr<DeepModel> model);
/// Makes a predictor that copies the last value of any layout. For values of the model's layout it
/// estimates the error.
[[nodiscard]] std::unique_ptr<ltm::Predictor> make_copies(std::shared_ptr<DeepModel> model);

/// Weights of the parts of a prediction.
struct BlendShares {
  double latents = 0;  ///< Of images.
  double motion = 0;   ///< Of images.
  double numbers = 0;
};

/// The expected value at one moment.
struct Future {
  Parts latents;                      ///< As predicted from latents.
  std::vector<torch::Tensor> motion;  ///< Images as predicted from motion.
};

/// The parts of the prediction that one horizon needs. A part whose gate is closed is not needed.
struct FutureNeed {
  int step = 1;
  bool latents = true;
  bool motion = true;
};

/// Computes the needed parts for several horizons in one rollout. The steps in `needs` ascend and
/// are distinct. Parts that are not needed stay empty.
[[nodiscard]] std::vector<Future> futures_of(DeepModel& model, const Parts& last,
                                             const Parts& before,
                                             std::span<const FutureNeed> needs);

/// Computes the futures at 1..`steps` steps after `last`, and encodes both values first.
[[nodiscard]] std::vector<Future> futures_of(DeepModel& model, const Parts& last,
                                             const Parts& before, int steps);

/// Adds to the last value the differences of the expected values to it, weighted by `shares`.
[[nodiscard]] Parts mix(const Parts& last, const Future& future, const BlendShares& shares);

}  // namespace engram::encoders
