// SPDX-License-Identifier: Apache-2.0
#include "training/forms/representation.h"

#include <algorithm>
#include <array>

#include "training/quality/psnr.h"

namespace engram::training {

namespace {

constexpr std::array<std::string_view, 4> kNames{"auto", "latents", "video", "corrected"};

}  // namespace

std::string_view to_string(Representation representation) {
  return kNames[static_cast<size_t>(representation)];
}

Result<Representation> representation_of(std::string_view text) {
  const auto found = std::ranges::find(kNames, text);
  if (found == kNames.end())
    return invalid_argument("representation: found '{}', needs auto, latents, video or corrected",
                            text);
  return static_cast<Representation>(found - kNames.begin());
}

Status RepresentationOptions::validate() const {
  if (bound_db != 0 && !(bound_db >= 10 && bound_db <= kLargestPsnrDb))
    return invalid_argument("bound of images: found {} dB, needs 10 to {}", bound_db,
                            kLargestPsnrDb);
  if (video != "av1" && video != "h265" && video != "h264")
    return invalid_argument("video codec: found '{}', needs av1, h265 or h264", video);
  if (video_effort < 0 || video_effort > 9)
    return invalid_argument("effort of the video codec: found {}, needs 0 to 9", video_effort);
  if (refine_steps < 0 || few_refine_steps < 0)
    return invalid_argument("steps of refining: found {} and {}, needs 0 or more", refine_steps,
                            few_refine_steps);
  if (nights < 1) return invalid_argument("nights: found {}, needs at least 1", nights);
  return {};
}

}  // namespace engram::training
