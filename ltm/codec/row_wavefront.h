// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to ltm/codec/row_prediction.cpp: restores bytes along a slanted front.
//
// A number needs its left, upper and corner neighbours. In a band of sixteen rows, row k is
// restored k columns behind the first. Everything that a step needs was then made by the two steps
// before it, and one vector holds the sixteen numbers of a step.
//
//     above   . . . . . u . .        one step restores the numbers x;
//     row 0   . . . . . x            their upper neighbours are the numbers of the step before,
//     row 1   . . . . x              moved by one lane,
//     row 2   . . . x                and their corners are the upper neighbours of that step

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "ltm/codec/row_prediction_loops.h"

namespace engram::ltm::row_loops {

constexpr size_t kLanes = 16;
using Lanes = uint8_t __attribute__((vector_size(kLanes)));
using Square = std::array<Lanes, kLanes>;

ENGRAM_INLINE Lanes load(const uint8_t* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, kLanes);
  return lanes;
}

ENGRAM_INLINE void store(Lanes lanes, uint8_t* to) {
  std::memcpy(to, &lanes, kLanes);
}

/// Transposes rows and columns by four perfect shuffles of its halves.
ENGRAM_INLINE void transpose(Square& square) {
  constexpr size_t kHalf = kLanes / 2;
  for (int round = 0; round < 4; ++round) {
    Square next;
    for (size_t i = 0; i < kHalf; ++i) {
      const Lanes a = square[i];
      const Lanes b = square[i + kHalf];
      next[2 * i] =
          __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
      next[2 * i + 1] = __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29,
                                                14, 30, 15, 31);
    }
    square = next;
  }
}

/// Moves every lane up by one; the last lane of `first` becomes the lowest.
ENGRAM_INLINE Lanes push(Lanes first, Lanes lanes) {
  return __builtin_shufflevector(first, lanes, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27,
                                 28, 29, 30);
}

ENGRAM_INLINE Lanes median_edges(Lanes left, Lanes upper, Lanes corner) {
  const Lanes min = left < upper ? left : upper;
  const Lanes max = left < upper ? upper : left;
  const Lanes above_min = corner > min ? corner : min;
  return min + max - (above_min < max ? above_min : max);
}

/// Sixteen rows of every channel and the row above them. Residuals are replaced by numbers in
/// place.
///
/// Each row is preceded by as many zeros as its lane starts late. Zeros below zeros have zero
/// residuals, so each row begins with equal left and corner numbers, as it must.
template <size_t kChannels>
class Band {
 public:
  explicit Band(size_t width)
      : width_(width),
        steps_((width + 2 * (kLanes - 1)) / kLanes * kLanes),
        stride_(steps_ + 2 * kLanes),
        bytes_(kChannels * (kLanes + 1) * stride_) {}

  ENGRAM_INLINE uint8_t* row(size_t channel, size_t k) {
    return above(channel) + (k + 1) * stride_;
  }

  ENGRAM_INLINE Rows<uint8_t, kChannels> rows(size_t k) {
    Rows<uint8_t, kChannels> rows;
    for (size_t c = 0; c < kChannels; ++c) rows[c] = row(c, k);
    return rows;
  }

  ENGRAM_INLINE void restore() {
    std::array<Front, kChannels> fronts{};
    for (size_t step = 0; step < steps_; step += kLanes) restore_squares(fronts, step);
  }

  /// Makes the last row the one above the next band.
  void advance() {
    for (size_t c = 0; c < kChannels; ++c) std::memcpy(above(c), row(c, kLanes - 1), width_);
  }

 private:
  using Squares = std::array<Square, kChannels>;

  /// The state that the next step of one channel needs.
  struct Front {
    Lanes left{};
    Lanes upper{};
  };

  ENGRAM_INLINE uint8_t* above(size_t channel) {
    return bytes_.data() + channel * (kLanes + 1) * stride_ + kLanes;
  }

  /// Restores sixteen steps of all channels. The channels are independent, which keeps the
  /// processor busy.
  ENGRAM_INLINE void restore_squares(std::array<Front, kChannels>& fronts, size_t step) {
    Squares squares;
    for (size_t c = 0; c < kChannels; ++c) {
      for (size_t k = 0; k < kLanes; ++k) squares[c][k] = load(row(c, k) + step - k);
      transpose(squares[c]);
    }
    for (size_t s = 0; s < kLanes; ++s)
      for (size_t c = 0; c < kChannels; ++c)
        squares[c][s] =
            restore_step(squares[c][s], load(above(c) + step + s - (kLanes - 1)), fronts[c]);
    for (size_t c = 0; c < kChannels; ++c) {
      transpose(squares[c]);
      for (size_t k = 0; k < kLanes; ++k) store(squares[c][k], row(c, k) + step - k);
    }
  }

  /// The last lane of `above` is the upper neighbour of the first row.
  ENGRAM_INLINE static Lanes restore_step(Lanes residuals, Lanes above, Front& front) {
    const Lanes upper = push(above, front.left);
    front.left = residuals + median_edges(front.left, upper, front.upper);
    front.upper = upper;
    return front.left;
  }

  size_t width_;
  size_t steps_;  ///< Number of steps until the last row is complete, in whole squares.
  size_t stride_;
  std::vector<uint8_t> bytes_;
};

}  // namespace engram::ltm::row_loops
