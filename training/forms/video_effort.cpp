// SPDX-License-Identifier: Apache-2.0
#include "training/forms/video_effort.h"

#include <cmath>
#include <vector>

#include "ltm/core/check.h"

namespace engram::training {

namespace {

// Measured on images of a humanoid's camera (36 dB; 35 dB at 640 x 480) and of a still one (42 and
// 40 dB) in chains of 16, libaom 3.6.
constexpr std::array<VideoEffort, 6> kVideoEfforts{{
    {"effort=7,depth=10,spread=2", 1.00, {0.105, 0.275, 0.516}},
    {"effort=6,depth=10,spread=2", 1.04, {0.042, 0.106, 0.233}},
    {"effort=5,depth=10,spread=2", 1.075, {0.0265, 0.065, 0.181}},
    {"effort=4,depth=10,spread=2", 1.155, {0.0149, 0.043, 0.127}},
    {"effort=3,depth=10,spread=2", 1.18, {0.0110, 0.030, 0.0825}},
    {"effort=3,spread=2", 1.25, {0.0082, 0.0215, 0.054}},
}};

/// Bytes of a search that ends within half a decibel of the bound, relative to the smallest video.
/// Source: experiments/learning/LOG.md, "residuals of videos".
constexpr double kQuickBytes = 1.09;

}  // namespace

double encodes_of_chain(double tolerance_db) {
  constexpr double kWithTolerance = 1.3, kWithout = 4.3;
  return tolerance_db > 0 ? kWithTolerance : kWithout;
}

std::span<const VideoEffort> video_efforts() {
  return kVideoEfforts;
}

// Time grows as a power of the pixels between two measured sizes, and below the smallest one as
// between the two that are nearest. Above the largest one it grows with the pixels, which is rather
// too much than too little.
double seconds_per_image(const VideoEffort& effort, int64_t pixels) {
  ENGRAM_CHECK(pixels > 0, "image of {} pixels", pixels);
  if (pixels > kMeasuredPixels.back())
    return effort.seconds.back() * static_cast<double>(pixels) /
           static_cast<double>(kMeasuredPixels.back());
  const size_t low = pixels < kMeasuredPixels[1] ? 0 : 1;
  const auto logarithm = [](auto value) { return std::log(static_cast<double>(value)); };
  const double share = (logarithm(pixels) - logarithm(kMeasuredPixels[low])) /
                       (logarithm(kMeasuredPixels[low + 1]) - logarithm(kMeasuredPixels[low]));
  return effort.seconds[low] * std::pow(effort.seconds[low + 1] / effort.seconds[low], share);
}

const VideoEffort& effort_within(double seconds, int64_t pixels) {
  for (const VideoEffort& effort : kVideoEfforts)
    if (seconds_per_image(effort, pixels) <= seconds) return effort;
  return kVideoEfforts.back();
}

// A night may take 0.07 s for an image of 128 x 128 pixels and 0.15 s for one of 640 x 480. Three
// quarters of that are for encoding, and a chain needs 1.3 encodes.
const VideoEffort& usual_effort(int64_t pixels) {
  constexpr double kSeconds = 0.04, kGrowth = 0.265;
  const double size = static_cast<double>(pixels) / static_cast<double>(kMeasuredPixels.front());
  return effort_within(kSeconds * std::pow(size, kGrowth), pixels);
}

VideoPace pace_within(double times, int64_t pixels, double usual_tolerance_db) {
  ENGRAM_CHECK(times > 0, "{} times the usual time", times);
  struct Search {
    double tolerance_db, bytes;
  };
  const Search quick{usual_tolerance_db, kQuickBytes}, whole{0, 1};
  const auto searches = usual_tolerance_db > 0 ? std::vector{quick, whole} : std::vector{whole};
  const auto seconds = [&](const VideoEffort& effort, const Search& search) {
    return seconds_per_image(effort, pixels) * encodes_of_chain(search.tolerance_db);
  };
  const double usual = seconds(usual_effort(pixels), searches.front());
  const VideoEffort& quickest = kVideoEfforts.back();
  VideoPace best{&quickest, searches.front().tolerance_db,
                 quickest.relative_bytes * searches.front().bytes,
                 seconds(quickest, searches.front()) / usual};
  for (const VideoEffort& effort : kVideoEfforts)
    for (const Search& search : searches)
      if (const double bytes = effort.relative_bytes * search.bytes;
          bytes < best.relative_bytes && seconds(effort, search) <= times * usual)
        best = {&effort, search.tolerance_db, bytes, seconds(effort, search) / usual};
  return best;
}

}  // namespace engram::training
