// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what was found lately in the images of one entity.

#include <optional>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/redaction/box.h"

namespace engram::ltm {

/// The boxes that were seen in the images of one entity, of which those count that were seen within
/// `hold` before or after a time. Times may come in any order.
///
/// A box is never lost while it counts. If there are too many, neighbours are joined to the hull of
/// both, for as long as either counts: that redacts more. One snapshot of a wrong time changes
/// nothing, because a box goes only when it did not count for kPatience snapshots in a row. Boxes
/// of later times, after a clock was set back, stay until room is needed.
/// Threading: one thread.
class HeldBoxes {
 public:
  static constexpr size_t kMax = 512;
  static constexpr int kPatience = 16;

  /// `max` is how many it holds before it joins some. It must be above zero.
  explicit HeldBoxes(size_t max = kMax) : max_(max) {}

  /// Notes that a snapshot of this time comes. To be called once for it, ahead of its images.
  void begin(Time time, Duration hold);

  /// Those that hold for an image of this time and are in none of `seen`, which are added to them.
  std::vector<RelativeBox> hold(const ImagePlace& place, Time time, Duration hold,
                                const std::vector<RelativeBox>& seen);

  /// Adds one that was seen. `hold` must be above zero.
  void add(const ImagePlace& place, Time time, Duration hold, const RelativeBox& box);

  [[nodiscard]] bool empty() const { return boxes_.empty(); }
  [[nodiscard]] size_t size() const { return boxes_.size(); }

 private:
  struct Held {
    std::optional<ImagePlace> place;  ///< Nothing: any image of the entity.
    RelativeBox box;
    /// It was seen at both, and never longer than twice the hold apart unless boxes were joined.
    Time first{}, last{};
    int missed = 0;  ///< The snapshots in a row for which it did not count.

    [[nodiscard]] bool counts(Time time, Duration hold) const;
  };

  void join_two(Duration hold);

  size_t max_;
  std::vector<Held> boxes_;  ///< In the order in which they came.
};

}  // namespace engram::ltm
