// SPDX-License-Identifier: Apache-2.0
#include "training/forms/representation.h"

#include <algorithm>
#include <array>

#include "training/forms/video_effort.h"
#include "training/forms/video_search.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

constexpr std::array<std::string_view, 4> kNames{"auto", "latents", "video", "corrected"};

/// Of H.264 and H.265, which are quick.
constexpr int kUsualEffort = 7;

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
  if (video_effort != kAutoEffort && (video_effort < 0 || video_effort > 9))
    return invalid_argument("effort of the video codec: found {}, needs 0 to 9", video_effort);
  if (!(video_tolerance_db >= 0 && video_tolerance_db <= 10))
    return invalid_argument("tolerance of videos: found {} dB, needs 0 to 10", video_tolerance_db);
  if (!(video_time > 0))
    return invalid_argument("time for videos: found {} times the usual, needs more than 0",
                            video_time);
  if (refine_steps < 0 || few_refine_steps < 0)
    return invalid_argument("steps of refining: found {} and {}, needs 0 or more", refine_steps,
                            few_refine_steps);
  if (nights && *nights < 1) return invalid_argument("nights: found {}, needs at least 1", *nights);
  return {};
}

VideoSearchOptions RepresentationOptions::search(int64_t pixels) const {
  const bool is_auto = video_effort == kAutoEffort;
  std::string settings = fmt::format("effort={}", is_auto ? kUsualEffort : video_effort);
  // Ten bits and an even quality: experiments/learning/LOG.md, "ladder of effort".
  if (video == "av1" && !is_auto) settings += ",depth=10,spread=2";
  if (video == "av1" && is_auto) {
    const VideoPace pace =
        pace_within(video_time, std::max<int64_t>(pixels, 1), video_tolerance_db);
    return {video, std::string(pace.effort->codec_options), bound_db, pace.tolerance_db};
  }
  return {video, std::move(settings), bound_db, video_tolerance_db};
}

}  // namespace engram::training
