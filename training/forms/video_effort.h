// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace engram::training {

/// One way to encode a chain of images with AV1 where every image must keep a bound of PSNR: what
/// it costs in bytes and in processor time.
struct VideoEffort {
  /// What follows "av1:crf=N,".
  std::string_view codec_options;
  /// Bytes relative to the first of the ladder, at the bound.
  double relative_bytes = 1;
  /// Processor time per image of one encode near the bound, at each of kMeasuredPixels. Machines
  /// differ by a factor, which the caller measures; the ratios hardly do.
  std::array<double, 3> seconds{};
};

/// The sizes that were measured: 128 x 128, 256 x 256, 640 x 480.
inline constexpr std::array<int64_t, 3> kMeasuredPixels{128 * 128, 256 * 256, 640 * 480};

/// From the fewest bytes to the least time. None of them is beaten in both by another.
///
/// Source: experiments/learning/LOG.md, "ladder of effort"; `make night-codec-bars` measures it.
[[nodiscard]] std::span<const VideoEffort> video_efforts();

/// Estimates the processor time of one encode of one image. Small images cost more per pixel.
/// `pixels` must be positive (checked).
[[nodiscard]] double seconds_per_image(const VideoEffort& effort, int64_t pixels);

/// Returns the rung with the fewest bytes whose encode of one image takes at most so many seconds,
/// or the quickest one.
[[nodiscard]] const VideoEffort& effort_within(double seconds, int64_t pixels);

/// How often a search encodes a chain, once it is known how quality follows from crf: with a
/// tolerance, and without one, where it looks for the smallest video.
/// Source: experiments/learning/LOG.md, "residuals of videos".
[[nodiscard]] double encodes_of_chain(double tolerance_db);

/// How the videos of a night are searched for.
struct VideoPace {
  const VideoEffort* effort = nullptr;
  /// A video may be so much better than its bound. Unit: dB.
  double tolerance_db = 0;
  /// Bytes relative to those of the first of the ladder without a tolerance.
  double relative_bytes = 1;
  /// Time relative to the usual: the quickest effort may take more than was asked for.
  double times = 1;
};

/// Returns the pace with the fewest bytes that takes at most `times` as long as the usual effort
/// with `usual_tolerance_db`, or the quickest one. More time is spent on better efforts, and on a
/// search without tolerance. `times` must be positive (checked).
[[nodiscard]] VideoPace pace_within(double times, int64_t pixels, double usual_tolerance_db);

/// Returns the rung of a usual night: eight hours of two cameras at 5 Hz are encoded in eight hours
/// of two cores, everything else included.
[[nodiscard]] const VideoEffort& usual_effort(int64_t pixels);

}  // namespace engram::training
