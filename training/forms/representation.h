// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "ltm/core/status.h"

namespace engram::training {

/// How the offline phase keeps images.
enum class Representation {
  kAuto,       ///< Each block in the cheapest form that keeps the bound.
  kLatents,    ///< Latents alone, whatever their error.
  kVideo,      ///< A video codec at the bound; no networks for images.
  kCorrected,  ///< Latents, and residuals where they miss the bound; another form where these fail.
};

[[nodiscard]] std::string_view to_string(Representation representation);
/// Errors: kInvalidArgument naming those there are.
Result<Representation> representation_of(std::string_view text);

struct RepresentationOptions {
  Representation kind = Representation::kAuto;
  /// Least PSNR of every image, but where kLatents was asked for; 0: that of the images' own noise
  /// (noise_floor.h). Unit: dB.
  double bound_db = 0;
  /// Where the bound follows from noise: of so many images, of this deviation in grey levels. Only
  /// told in reports.
  int64_t noise_images = 0;
  double noise = 0;
  /// The group codec that latents compete with.
  std::string video = "av1";
  int video_effort = 7;
  /// Steps of refining the latents of every block (latent_refinement.h): some 20 ms of one core per
  /// image and step; 0: only where a few of them may be enough, see below.
  int refine_steps = 0;
  /// Steps for blocks that miss the bound, but no image by more than this; 0: none. Unit: dB.
  int few_refine_steps = 8;
  double refine_within_db = 1.5;
  /// Nights like this one that a model will serve: what its bytes are shared by.
  int nights = 30;

  [[nodiscard]] Status validate() const;
};

}  // namespace engram::training
