// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "encoders/coding/adaptive_bit.h"
#include "encoders/coding/block_transform.h"
#include "encoders/coding/integer_coder.h"
#include "encoders/coding/mixed_bits.h"

namespace engram::encoders {

/// Number of steps of the quantiser: eight per doubling, from half a grey level on.
inline constexpr int kResidualSteps = 80;
inline constexpr int kResidualStepBits = 7;

/// Size of a step. Unit: 1/8 grey level, as for coefficients.
[[nodiscard]] int32_t residual_step(int index);

/// The residual of one image as integers.
struct QuantisedResidual {
  explicit QuantisedResidual(const BlockGrid& grid)
      : continues(grid.blocks()), levels(grid.coefficients()) {}

  int step = 0;                    ///< Below kResidualSteps.
  std::vector<uint8_t> continues;  ///< [blocks]: whether levels are added to the last residual.
  std::vector<int16_t> levels;     ///< [blocks, 64], in steps.
};

/// Encodes and decodes the residuals of consecutive images. Known levels around a bit, in this
/// image and the last residual, are its contexts.
///
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "Residuals".
class ResidualCoder {
 public:
  explicit ResidualCoder(const BlockGrid& grid);

  /// Encodes an image, or decodes into `image`; any bits decode to one.
  template <typename Port>
  void code(Port& port, QuantisedResidual& image);

  /// The residual of an image that follows the coded ones, as coefficients.
  [[nodiscard]] std::vector<int16_t> after(const QuantisedResidual& image) const;

  /// The residual of the last image; zeros before the first.
  [[nodiscard]] const std::vector<int16_t>& last() const { return last_; }

 private:
  static constexpr size_t kSize = BlockGrid::kCoefficients;
  static constexpr size_t kPlanes = 3;  ///< Planes that contexts distinguish.
  static constexpr size_t kBands = 8;   ///< Bands of places in a block.
  static constexpr size_t kLongest = 14;

  /// A block and pointers to its contexts.
  struct Place {
    size_t plane = 0;  ///< As contexts distinguish it.
    size_t block = 0;
    const int16_t* left = nullptr;  ///< Levels of the neighbours; null at the edge.
    const int16_t* above = nullptr;
    const int16_t* before = nullptr;  ///< Levels in the plane before.
    size_t left_end = 0, above_end = 0, before_end = 0;
    /// 0 if the block had no choice, else 1 or 2.
    size_t left_mode = 0, above_mode = 0, before_mode = 0;
  };
  /// The contexts of a place in the current block.
  struct Neighbourhood {
    size_t beside = 0;  ///< Magnitudes at this place in the left and upper blocks, at most 3.
    size_t near = 0;    ///< Magnitudes of the two levels before, at most 3.
    size_t before = 0;  ///< Magnitude in the plane before, at most 2.
    size_t last = 0;    ///< Class of the last residual, in steps; plus 5 if the block continues it.
  };

  [[nodiscard]] Place place_of(const QuantisedResidual& image, size_t plane, size_t row,
                               size_t column) const;
  [[nodiscard]] Neighbourhood around(const Place& place, const int16_t* levels, size_t at,
                                     bool continues) const;
  [[nodiscard]] size_t last_class(size_t index) const;
  template <typename Port>
  void code_block(Port& port, const Place& place, QuantisedResidual& image);
  template <typename Port>
  void code_levels(Port& port, const Place& place, bool continues, int16_t* levels);
  template <typename Port>
  int code_magnitude(Port& port, size_t band, const Neighbourhood& known, int magnitude);

  /// Updates `last` from the residual before a block of `image` to the one after it.
  void add_to(std::vector<int16_t>& last, const QuantisedResidual& image, size_t block) const;

  BlockGrid grid_;
  int32_t step_ = 1;
  std::vector<int16_t> last_;
  std::vector<uint8_t> has_last_;  ///< [blocks]: whether any of last_ is not zero.
  std::vector<uint8_t> ends_;      ///< [blocks]: index after the last level that is not zero.
  std::vector<uint8_t> modes_;     ///< [blocks]: as in Place.
  std::array<AdaptiveBit, 27> continues_;
  MixedBits<4> coded_;
  MixedBits<5> zero_;
  MixedBits<3> end_;
  MixedBits<3> larger_;
  IntegerModel rest_;
};

}  // namespace engram::encoders
