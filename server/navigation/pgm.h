// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: pictures of grey values as maps have them.

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::navigation {

/// A picture of grey values.
struct GreyPicture {
  cv::Mat pixels;  ///< CV_16UC1, row 0 on top.
  int max_value = 255;
};

/// Reads the bytes of a PGM file, P2 or P5; safe on hostile bytes. `name` is its name in errors.
/// Errors: kDataLoss, naming what was found and what was needed.
Result<GreyPicture> parse_pgm(std::string_view bytes, const std::string& name);

/// Writes a picture of 8 bits, CV_8UC1, as P5.
[[nodiscard]] std::string pgm_of(const cv::Mat& pixels);

}  // namespace engram::navigation
