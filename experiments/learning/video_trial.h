// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::experiments {

/// What one chain of images became.
struct TrialResult {
  double bytes = 0;
  std::vector<double> psnr_db;  ///< Per image.
  double encode_seconds = 0;    ///< Processor time of the whole chain.
  double decode_seconds = 0;

  [[nodiscard]] double min_db() const;
  [[nodiscard]] double mean_db() const;
};

/// A video encoder of libavcodec with any options, to try what no option of ltm/codec offers yet.
///
/// The text names a group codec as make_group_codec does, without its crf
/// ("av1:effort=5,spread=2"), or an encoder, a pixel format and options: "libaom-av1 yuv444p10
/// cpu-used=3 aom.enable-cdef=0". `aom.`, `x265.` and `svt.` begin options of the library behind
/// the encoder; `qmin` and `qmax` count from the crf. What ltm/codec always sets is set here as
/// well.
///
/// Threading: one thread; encoders may start their own.
class VideoTrial {
 public:
  /// Errors: kInvalidArgument, kFailedPrecondition if there is no such encoder or format.
  static Result<VideoTrial> create(const std::string& text);

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] int max_crf() const;

  /// Encodes and decodes images of one size. Shape of each: uint8 [H, W, 3].
  /// Errors: kInvalidArgument if the encoder refuses options or images.
  Result<TrialResult> run(std::span<const idf::NdArray> images, int crf) const;

 private:
  [[nodiscard]] bool is_group_codec() const { return encoder_.empty(); }

  std::string text_;
  std::string encoder_;  ///< Empty if the text names a group codec.
  std::string format_;
  std::vector<std::pair<std::string, std::string>> options_;
};

}  // namespace engram::experiments
