// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "encoders/dynamics.h"
#include "encoders/provenance.h"
#include "encoders/tensor_plan.h"
#include "ltm/core/time.h"
#include "ltm/recall/model.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// Horizons that a model's gates and errors are measured for.
inline constexpr int kMeasuredHorizons = 5;

/// How well a model predicts, per horizon from 1 on.
struct PredictionRecord {
  /// Share of the deep change that is added to the last value: zero is copy-last.
  std::array<double, kMeasuredHorizons> image_gates{};
  std::array<double, kMeasuredHorizons> number_gates{};
  std::array<ltm::MeasuredError, kMeasuredHorizons> expected{};
  Duration step{};
};

/// Everything that a model file holds.
///
/// Threading: one thread.
struct DeepModel {
  /// Freshly initialised networks. Uses LibTorch's random generator.
  DeepModel(TensorPlan plan, const NetworkShape& shape);

  TensorPlan plan;
  std::vector<double> mean;       ///< Per number.
  std::vector<double> deviation;  ///< Per number; 0 where it never changed: it is its mean.
  Autoencoder autoencoder;
  Dynamics dynamics;
  LatentCoder coder;
  PredictionRecord prediction;
  Provenance provenance;

  /// Numbers in units of their deviation from the mean; 0 for those that are not finite.
  [[nodiscard]] std::vector<float> normalise(std::span<const double> numbers) const;

  /// The images of one value in grey levels, padded, and its numbers, normalised. Batch of one.
  /// Errors: kInvalidArgument where the value has another layout.
  Result<Parts> to_parts(const idf::SplitValue& value) const;

  /// The value of one row of a batch.
  Result<idf::Data> to_value(const Parts& parts, const idf::List& remainder) const;

  /// Rounded latents of a batch of one as integers, and back.
  [[nodiscard]] std::vector<int32_t> to_integers(const Parts& latents) const;
  [[nodiscard]] Parts to_latents(std::span<const int32_t> integers) const;

  Result<ltm::Latent> encode(const idf::Data& value);
  Result<idf::Data> decode(const ltm::Latent& latent);
};

/// Pixels [B, H, W, C] as they lie in memory -> [B, C, H, W] in grey levels, padded by repeating
/// the edge.
[[nodiscard]] torch::Tensor to_grey_levels(const ImageMember& image, const ImageShape& shape,
                                           const torch::Tensor& pixels);

/// The network sizes for a layout. `width` and `latent_channels` as in NetworkShape.
[[nodiscard]] NetworkShape network_shape(const TensorPlan& plan, int width, int latent_channels);

/// Rounds all weights to what a model file keeps: 8 bits per weight and a scale per output
/// channel, whole grey levels for backgrounds, 32-bit floats for vectors.
void round_weights(torch::nn::Module& module);

/// How a model file keeps a tensor.
enum class Kept { kBytes, kPixels, kFloats };
[[nodiscard]] Kept kept_as(const std::string& name, const torch::Tensor& tensor, bool is_buffer);

/// Scale of one output channel, such that weights are scale * [-127, 127]; exact when repeated.
[[nodiscard]] float weight_scale(float largest);

/// What training and queries both see of a model.
[[nodiscard]] std::unique_ptr<ltm::Encoder> make_encoder(std::shared_ptr<DeepModel> model);
[[nodiscard]] std::unique_ptr<ltm::Predictor> make_predictor(std::shared_ptr<DeepModel> model);

/// Adds `gates` times the difference between prediction and last value to the last value.
[[nodiscard]] Parts mix(const Parts& last, const Parts& predicted, double image_gate,
                        double number_gate);

}  // namespace engram::encoders
