// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what was found lately in the images of one entity.

#include <deque>
#include <string>
#include <vector>

#include "ltm/core/time.h"

namespace engram::ltm {

/// A box as parts of the image's sides, so that it holds if the size of images changes. 0..1.
struct RelativeBox {
  double left = 0, top = 0, right = 0, bottom = 0;

  [[nodiscard]] bool contains(const RelativeBox& other) const {
    return left <= other.left && top <= other.top && right >= other.right && bottom >= other.bottom;
  }
};

/// An image of an entity.
struct ImagePlace {
  size_t instance = 0;
  std::string member;
  int64_t image = 0;

  friend bool operator==(const ImagePlace&, const ImagePlace&) = default;
};

/// The boxes that were seen in the images of one entity, of which those count that were seen within
/// `hold` before or after a time. Times may come in any order; if a clock is set back, boxes of the
/// later times wait until they count again, or until kMax newer ones came.
///
/// Threading: one thread.
class HeldBoxes {
 public:
  static constexpr size_t kMax = 512;

  /// Those that hold for an image of this time and are in none of `seen`, which are added to them.
  std::vector<RelativeBox> hold(const ImagePlace& place, Time time, Duration hold,
                                const std::vector<RelativeBox>& seen);

  [[nodiscard]] bool empty() const { return boxes_.empty(); }

  /// Whether nothing of it holds at this time or later.
  [[nodiscard]] bool is_over(Time time, Duration hold) const;

 private:
  struct Held {
    ImagePlace place;
    RelativeBox box;
    Time seen{};
  };
  std::deque<Held> boxes_;  ///< In the order in which they came.
};

}  // namespace engram::ltm
