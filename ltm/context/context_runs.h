// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace engram::ltm {

struct EntityContext;

/// The smallest and the largest of some numbers in rows of a table, of runs of 16 rows, of 32, and
/// so on: what holds for all rows of a run is told at once.
///
/// Threading: immutable once it is made.
/// Complexity: 2 W floats for 8 rows; bounds of any range in O(1).
template <size_t W>
class RunBounds {
 public:
  struct Bounds {
    std::array<float, W> low, high;  ///< Rounded away from what they bound.
    friend bool operator==(const Bounds&, const Bounds&) = default;
  };

  /// Adds the next row. A number that is not finite, or that no float holds, bounds nothing.
  void add(const std::array<double, W>& row);
  /// Makes the longer runs, once all rows are there.
  void finish();

  [[nodiscard]] size_t rows() const { return rows_; }
  [[nodiscard]] size_t held_bytes() const;

  /// Bounds of rows `begin` to before `end`, and perhaps of a few beside them. `begin` < `end` <=
  /// rows().
  [[nodiscard]] Bounds of(size_t begin, size_t end) const;

 private:
  static constexpr size_t kRun = 16;

  size_t rows_ = 0;
  std::vector<std::vector<Bounds>> levels_;
};

extern template class RunBounds<3>;
extern template class RunBounds<12>;

/// What follows from the places and cameras of a context: bounds of runs of them.
///
/// Threading: immutable once it is made.
class ContextRuns {
 public:
  /// Fewer rows are looked at one by one.
  static constexpr size_t kMinRows = 256;

  explicit ContextRuns(const EntityContext& context);

  /// Whether it is about the rows of this context, which nobody changed since.
  [[nodiscard]] bool is_of(const EntityContext& context) const;

  RunBounds<3> places;  ///< Positions. Unit: m.
  /// The rotation from the camera to its frame, row by row, and the position in m.
  RunBounds<12> cameras;
  /// The frame of all places, and of all cameras; nothing if they differ.
  std::optional<uint32_t> place_frame, camera_frame;
  /// A row of a camera that has the intrinsics of all; nothing if they differ.
  std::optional<size_t> lens_row;
  /// Each snapshot has this many places or cameras; 0 if they differ.
  size_t places_each = 0, cameras_each = 0;

  [[nodiscard]] size_t held_bytes() const { return places.held_bytes() + cameras.held_bytes(); }
};

}  // namespace engram::ltm
