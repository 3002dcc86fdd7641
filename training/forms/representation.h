// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "ltm/core/status.h"

namespace engram::training {

/// The form in which the offline phase keeps images.
enum class Representation {
  kAuto,       ///< Each block in the cheapest form that keeps the bound.
  kLatents,    ///< Latents alone, whatever their error.
  kVideo,      ///< A video codec at the bound; no networks for images.
  kCorrected,  ///< Latents, with residuals if they miss the bound; another form only if these fail.
};

[[nodiscard]] std::string_view to_string(Representation representation);
/// Errors: kInvalidArgument, with the valid names.
Result<Representation> representation_of(std::string_view text);

struct RepresentationOptions {
  Representation kind = Representation::kAuto;
  /// Min PSNR of every image, unless `kind` is kLatents; 0 for the PSNR of the images' own noise
  /// (noise_floor.h). Unit: dB.
  double bound_db = 0;
  /// If the bound follows from noise: the number of measured images and the deviation in grey
  /// levels. Both are for reports only.
  int64_t noise_images = 0;
  double noise = 0;
  /// The group codec that latents compete with.
  std::string video = "av1";
  int video_effort = 7;
  /// Steps of refinement for every block (latent_refinement.h). A step costs about 20 ms of one
  /// core per image. With 0 only blocks for which a few steps may suffice are refined, see below.
  int refine_steps = 0;
  /// Steps for blocks that miss the bound, but in no image by more than refine_within_db (in dB); 0
  /// for none.
  int few_refine_steps = 8;
  double refine_within_db = 1.5;
  /// Number of nights like this one over which the bytes of a model are divided.
  int nights = 30;

  [[nodiscard]] Status validate() const;
};

}  // namespace engram::training
