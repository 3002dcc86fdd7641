// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "ltm/core/status.h"

namespace engram::encoders {

/// The loss that latents were trained for. Networks, codec, storage and prediction are the same in
/// all variants.
///
/// Source: docs/learning_methods.md, section "Training variants". Papers: Ballé et al., End-to-end
/// Optimized Image Compression, 2017 (rate); Kingma and Welling, Auto-Encoding Variational Bayes,
/// 2014 (vae); Tolstikhin et al., Wasserstein Auto-Encoders, 2018 (wae).
enum class TrainingVariant : uint8_t {
  kRateAware,    ///< "rate": squared error and the bits that latents take.
  kAutoencoder,  ///< "ae": squared error alone.
  kVae,          ///< "vae": squared error and divergence from a Gaussian prior.
  kWae,          ///< "wae": squared error and how far pooled latents are from a Gaussian (MMD).
};
inline constexpr std::array kTrainingVariants{TrainingVariant::kRateAware,
                                              TrainingVariant::kAutoencoder, TrainingVariant::kVae,
                                              TrainingVariant::kWae};

/// "rate", "ae", "vae", "wae".
[[nodiscard]] std::string_view to_string(TrainingVariant variant);

/// Errors: kInvalidArgument if no variant has that name.
Result<TrainingVariant> training_variant_of(std::string_view name);

}  // namespace engram::encoders
