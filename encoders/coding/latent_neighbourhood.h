// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "encoders/coding/latent_grid.h"

namespace engram::encoders {

/// Classes of values and sums, from which contexts are made.
namespace latent_classes {

/// Magnitudes are capped here, because no class distinguishes larger ones.
inline constexpr int kMax = 9;
using ValueTable = std::array<uint8_t, 2 * kMax + 1>;  // From -kMax on.
// Indexed by sums of at most seven magnitudes.
using SumTable = std::array<uint8_t, 128>;

/// Maps each value from -`max` to `max` to a class; values beyond share the classes at the ends.
constexpr ValueTable values_up_to(int max) {
  ValueTable table{};
  for (int value = -kMax; value <= kMax; ++value)
    table[static_cast<size_t>(value + kMax)] =
        static_cast<uint8_t>(std::clamp(value, -max, max) + max);
  return table;
}
inline constexpr ValueTable kWideOf = values_up_to(3);
inline constexpr ValueTable kNarrowOf = values_up_to(2);

/// Classes of sums: 0, 1, 2, 3 to 4, 5 to 8, and more.
inline constexpr SumTable kStepOf = [] {
  SumTable table{};
  for (size_t i = 0; i < table.size(); ++i)
    table[i] = static_cast<uint8_t>(i <= 2 ? i : i <= 4 ? 3 : i <= 8 ? 4 : 5);
  return table;
}();

/// Classes of sums: 0, 1 to 2, 3 to 6, and more.
inline constexpr SumTable kFewOf = [] {
  SumTable table{};
  for (size_t i = 0; i < table.size(); ++i)
    table[i] = static_cast<uint8_t>(i == 0 ? 0 : i <= 2 ? 1 : i <= 6 ? 2 : 3);
  return table;
}();

}  // namespace latent_classes

/// Computes the classes of the known neighbours of each latent of one grid while the rows of a
/// block are coded.
///
/// All values are bytes in planes with a border of zeros. Sums over previous rows and channels are
/// computed for a whole channel at once, and no code has to check for the edge of a plane.
/// Shape: planes of [height + 2, width + 2]; `at` is an index into one (place()).
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "Sequences of latents".
class LatentNeighbourhood {
 public:
  /// Number of classes of each kind: sums, coarser sums, values from -3 to 3 and from -2 to 2.
  static constexpr size_t kSteps = 6;
  static constexpr size_t kFewSteps = 4;
  static constexpr size_t kWide = 7;
  static constexpr size_t kNarrow = 5;

  /// The classes of one latent before it is known. Before the first row all rows count as zeros;
  /// after the first row, the row before it counts as equal to it.
  struct Classes {
    size_t last;         ///< Wide: the same latent in the last row.
    size_t before;       ///< Wide: the same latent in the row before that.
    size_t past;         ///< Narrow: the same value as `before`.
    size_t last_size;    ///< Its magnitude in the last row: 0, 1 or more.
    size_t west, north;  ///< Narrow: neighbours.
    size_t around;       ///< Step: magnitudes around it.
    size_t around_then;  ///< Step: magnitudes around it in the last row.
    size_t channels;     ///< Few: magnitudes in the four previous channels.
    size_t change;       ///< Step: difference of neighbours and those channels from the last row.
  };

  explicit LatentNeighbourhood(const LatentGrid& shape);

  /// Forgets all rows.
  void begin_block();

  /// Begins a channel. The previous channels of this row must be complete.
  void begin_channel(int channel);

  /// Ends the row, which then is the last row.
  void end_row();

  /// Index in a plane with a border of a latent of a plane [height, width].
  [[nodiscard]] size_t place(size_t latent) const { return places_[latent]; }

  /// Classes of a latent of the current channel. The latents to the left and above must be known.
  [[nodiscard]] Classes classes(size_t at) const;

  /// Stores a latent of the current channel; `last` is its value in the last row.
  void put(size_t at, int32_t value, int32_t last);

  /// Computes the difference of this row from the last one over all channels, as "few" classes, at
  /// each place of a grid of another size.
  /// Shape: [height, width] of `other`.
  void find_changes(const LatentGrid& other, std::span<uint8_t> changes) const;

 private:
  static constexpr int kMax = latent_classes::kMax;
  using Planes = std::vector<int8_t>;

  static size_t of(const latent_classes::ValueTable& table, int value) {
    return table[static_cast<size_t>(value + kMax)];
  }
  static size_t of(const latent_classes::SumTable& table, int sum) {
    return table[static_cast<size_t>(sum)];
  }

  LatentGrid shape_;
  size_t stride_;
  size_t plane_;
  std::vector<size_t> places_;
  size_t rows_ = 0;
  size_t first_ = 0;  ///< Offset of the planes of the current channel.
  // Planes of all channels: values of this row and the last two, magnitudes of this row, and its
  // differences from the last row.
  Planes now_, last_, before_, size_, distance_;
  // Planes of the current channel: sums around each place in the last row, and over the previous
  // channels.
  Planes around_then_, channels_, change_;
};

// These functions are inline, because they are called for every latent.

inline LatentNeighbourhood::Classes LatentNeighbourhood::classes(size_t at) const {
  using namespace latent_classes;
  const size_t it = first_ + at;
  const int8_t* size = size_.data() + it;
  const int8_t* distance = distance_.data() + it;
  const auto stride = static_cast<ptrdiff_t>(stride_);
  const int last = last_[it], before = before_[it];
  const int around = 2 * (size[-1] + size[-stride]) + size[-stride - 1] + size[-stride + 1];
  const int change = change_[at] + distance[-1] + distance[-stride] + distance[-stride + 1];
  return {of(kWideOf, last),           of(kWideOf, before),
          of(kNarrowOf, before),       static_cast<size_t>(std::min(std::abs(last), 2)),
          of(kNarrowOf, now_[it - 1]), of(kNarrowOf, now_[it - stride_]),
          of(kStepOf, around),         of(kStepOf, around_then_[at]),
          of(kFewOf, channels_[at]),   of(kStepOf, change)};
}

inline void LatentNeighbourhood::put(size_t at, int32_t value, int32_t last) {
  const auto capped = [](int64_t magnitude) {
    return static_cast<int8_t>(std::min<int64_t>(magnitude, kMax));
  };
  const size_t it = first_ + at;
  now_[it] = static_cast<int8_t>(std::clamp(value, -kMax, kMax));
  size_[it] = capped(std::abs(int64_t{value}));
  distance_[it] = capped(std::abs(int64_t{value} - last));
}

}  // namespace engram::encoders
