// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace engram::training {

/// What one encode of a chain showed.
struct VideoTrial {
  int crf = 0;
  double worst_db = 0;  ///< PSNR of the chain's worst image.
  uint64_t bytes = 0;
};

/// How quality follows from a codec's crf in one image member of an entity, learned from the chains
/// that were encoded. Consecutive chains need similar qualities, so most searches can begin where
/// they end.
///
/// The PSNR of a chain's worst image is taken for a line: a level, which differs from chain to
/// chain, minus a slope times crf.
/// Threading: one thread; the const functions may run beside each other.
class VideoHistory {
 public:
  /// Measured with AV1 between 34 and 40 dB: 0.2 for images of 128 x 128 pixels, 0.35 for noisy
  /// ones of 640 x 480.
  static constexpr double kUsualBytesPerDb = 0.25;

  /// `usual_slope` is in dB per step of crf, and counts until some chain was encoded twice.
  explicit VideoHistory(double usual_slope) { line_.slope = usual_slope; }

  /// What it knows of the line, without the chains.
  struct Line {
    double slope = 0;  ///< In dB per step of crf.
    /// A point of the line: near where the last chain ended, so that another slope moves little.
    double at_crf = 0, at_db = 0;
    /// How much the logarithm of a chain's bytes grows with a decibel.
    double bytes_per_db = kUsualBytesPerDb;

    friend bool operator==(const Line&, const Line&) = default;
  };

  [[nodiscard]] const Line& line() const { return line_; }

  /// Goes on from a line of an earlier job. Nothing happens if some chain was learned from, or the
  /// line is none that a codec has.
  void go_on_from(const Line& line);

  [[nodiscard]] bool is_empty() const { return chains_ == 0; }

  /// The worst crf that should keep `bound_db` in a chain like the last ones, but for half of
  /// `tolerance_db`: residuals of the few images that miss it take fewer bytes than the same
  /// decibels of all images.
  [[nodiscard]] int first_guess(double bound_db, double tolerance_db) const;

  /// How far crf must fall (a negative number) or may rise so that quality goes from that of the
  /// last of `trials`, which are of one chain, to `wanted_db`.
  [[nodiscard]] double change_to(double wanted_db, std::span<const VideoTrial> trials) const;

  /// Adds the trials of the next chain, of which there is at least one (checked). The last one that
  /// counts is the one nearest to the bound.
  void learn(std::span<const VideoTrial> trials, double bound_db);

  /// Encodes of each chain so far.
  [[nodiscard]] std::span<const uint8_t> encodes() const { return encodes_; }

 private:
  Line line_;
  uint64_t chains_ = 0;  ///< One at least if the line is of an earlier job.
  std::vector<uint8_t> encodes_;
};

}  // namespace engram::training
