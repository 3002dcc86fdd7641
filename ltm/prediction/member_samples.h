// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/memory/source.h"
#include "ltm/prediction/value_row.h"

namespace engram::ltm {

/// Samples of the elements of the images and large arrays in one value.
struct MemberSample {
  std::vector<std::vector<float>> elements;  ///< One vector per ValueRow::other_members().
  /// Per member, the grey levels that a difference of one is; 1 for numbers.
  std::vector<float> scales;
};

/// Measures at low cost how much the images and large arrays of two values differ. It compares at
/// most kMaxElements of each, at fixed places that are spread evenly over it.
///
/// Threading: immutable.
class MemberSamples {
 public:
  static constexpr size_t kMaxElements = 16384;

  explicit MemberSamples(const ValueRow& rows);

  [[nodiscard]] MemberSample sample(const idf::SplitValue& value) const;

  /// The error over all members. Images of 16 bits are scaled to grey levels, 255 for the largest
  /// value of `recorded`. Pairs of numbers with one that is not finite are left out.
  [[nodiscard]] MeasuredError difference(const MemberSample& recorded,
                                         const MemberSample& other) const;

  /// The same per member of ValueRow::other_members(), in their order; NaN for a member without any
  /// finite element.
  [[nodiscard]] std::vector<double> differences(const MemberSample& recorded,
                                                const MemberSample& other) const;

  [[nodiscard]] bool has_images() const { return images_ > 0; }
  /// Number of elements of all members that are not images.
  [[nodiscard]] size_t number_elements() const { return numbers_; }

 private:
  struct Part {
    size_t member = 0;  ///< Index into the layout's members.
    bool is_image = false;
    double weight = 0;  ///< Number of its elements.
    std::vector<size_t> places;
  };

  std::vector<Part> parts_;
  size_t images_ = 0;   ///< Number of members that are images.
  size_t numbers_ = 0;  ///< Number of elements that are not in images.
};

}  // namespace engram::ltm
