// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::ltm {

/// A part of an image. It may reach beyond the image. Unit: pixels; x to the right, y down.
struct Box {
  double x = 0;  ///< Of the left edge.
  double y = 0;  ///< Of the upper edge.
  double width = 0;
  double height = 0;

  friend bool operator==(const Box&, const Box&) = default;
};

/// Max number of boxes of one image. An answer with more is refused.
inline constexpr size_t kMaxBoxes = 10'000;

/// Reads the answer of a program for an image of this number: {"image": NUMBER, "boxes": [[x, y,
/// width, height], ...]}. Safe on hostile text.
/// Errors: kInvalidArgument naming what was found and what was needed: another image or key, a
/// number that is not finite, a size that is not above zero, too many boxes.
Result<std::vector<Box>> parse_boxes(std::string_view json, uint64_t image);

}  // namespace engram::ltm
