// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
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

/// A box as parts of the image's sides, so that it holds if the size of images changes. 0..1.
struct RelativeBox {
  double left = 0, top = 0, right = 0, bottom = 0;

  [[nodiscard]] bool contains(const RelativeBox& other) const {
    return left <= other.left && top <= other.top && right >= other.right && bottom >= other.bottom;
  }
  [[nodiscard]] double area() const { return (right - left) * (bottom - top); }

  friend bool operator==(const RelativeBox&, const RelativeBox&) = default;
};

/// The smallest box that contains both.
[[nodiscard]] inline RelativeBox hull(const RelativeBox& a, const RelativeBox& b) {
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
          std::max(a.bottom, b.bottom)};
}

/// An image of an entity.
struct ImagePlace {
  size_t instance = 0;
  std::string member;  ///< The path in the value.
  int64_t image = 0;

  friend bool operator==(const ImagePlace&, const ImagePlace&) = default;
};

/// Max number of boxes of one image. An answer with more is refused.
inline constexpr size_t kMaxBoxes = 10'000;

/// Reads the answer of a program for an image of this number: {"image": NUMBER, "boxes": [[x, y,
/// width, height], ...]}. Safe on hostile text.
/// Errors: kInvalidArgument naming what was found and what was needed: another image or key, a
/// number that is not finite, a size that is not above zero, too many boxes.
Result<std::vector<Box>> parse_boxes(std::string_view json, uint64_t image);

}  // namespace engram::ltm
