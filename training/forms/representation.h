// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "ltm/core/status.h"

namespace engram::training {

class EntityVideos;
struct VideoSearchOptions;

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

inline constexpr int kAutoEffort = -1;

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
  /// Effort of that codec; kAutoEffort for one by the size of the images, so that a night suffices
  /// for a day.
  int video_effort = kAutoEffort;
  /// A video may be so much better than the bound; 0 for the smallest one that keeps it, which
  /// takes more encodes. Unit: dB.
  double video_tolerance_db = 0.5;
  /// Times the processor time of a usual night that the search for videos may take, unless
  /// `video_effort` is given: more takes fewer bytes.
  double video_time = 1;
  /// Threads that search for videos. The result does not depend on it.
  int threads = 1;
  /// What the job knows about the videos of this entity; may be null.
  std::shared_ptr<EntityVideos> videos;
  /// Steps of refinement for every block (latent_refinement.h). A step costs about 20 ms of one
  /// core per image. With 0 only blocks for which a few steps may suffice are refined, see below.
  int refine_steps = 0;
  /// Steps for blocks that miss the bound, but in no image by more than refine_within_db (in dB); 0
  /// for none.
  int few_refine_steps = 8;
  double refine_within_db = 1.5;
  /// Number of nights like this one over which the bytes of a model are divided. If it is not
  /// given, those of a first model are divided over kFirstNights, and those of one that replaces
  /// another over as many as that one served: what models cost is then at most what they saved.
  std::optional<int> nights{};
  static constexpr int kFirstNights = 30;

  [[nodiscard]] Status validate() const;

  [[nodiscard]] int first_nights() const { return nights.value_or(kFirstNights); }

  /// How videos of images of so many pixels are searched for.
  [[nodiscard]] VideoSearchOptions search(int64_t pixels) const;
};

}  // namespace engram::training
