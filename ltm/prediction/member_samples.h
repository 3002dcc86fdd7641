// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/memory/source.h"
#include "ltm/prediction/value_row.h"

namespace engram::ltm {

/// Elements of the images and large arrays of one value.
struct MemberSample {
  std::vector<std::vector<float>> elements;  ///< Of each of ValueRow::other_members().
  /// Per member: what a difference of one is in grey levels; 1 for numbers.
  std::vector<float> scales;
};

/// Tells cheaply how much the images and large arrays of two values differ: by kMaxElements of
/// each, spread evenly over it, always the same.
///
/// Threading: immutable.
class MemberSamples {
 public:
  static constexpr size_t kMaxElements = 16384;

  explicit MemberSamples(const ValueRow& rows);

  [[nodiscard]] MemberSample sample(const idf::SplitValue& value) const;

  /// Images of 16 bits count in grey levels, 255 for the largest value of `recorded`. Numbers of
  /// which one is not finite are left out.
  [[nodiscard]] MeasuredError difference(const MemberSample& recorded,
                                         const MemberSample& other) const;

  /// The same of each of ValueRow::other_members(), in their order; not a number without any finite
  /// element.
  [[nodiscard]] std::vector<double> differences(const MemberSample& recorded,
                                                const MemberSample& other) const;

  [[nodiscard]] bool has_images() const { return images_ > 0; }
  /// Of all members that are no images.
  [[nodiscard]] size_t number_elements() const { return numbers_; }

 private:
  struct Part {
    size_t member = 0;  ///< Of the layout.
    bool is_image = false;
    double weight = 0;  ///< Number of its elements.
    std::vector<size_t> places;
  };

  std::vector<Part> parts_;
  size_t images_ = 0;   ///< Members.
  size_t numbers_ = 0;  ///< Elements.
};

}  // namespace engram::ltm
