// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "encoders/coding/number_model.h"
#include "ltm/idf/layout.h"

namespace engram::encoders {

/// Size and scale of an image member.
struct ImageMember {
  size_t member = 0;  ///< Index into Layout::members().
  int height = 0;
  int width = 0;
  int channels = 0;
  /// Grey levels per unit of the image: 1 for uint8; the model chooses it for uint16.
  double scale = 1;
  bool is_depth = false;  ///< uint16.
};

/// A numeric member: `count` numbers from `first` on in the vector of all numbers.
struct NumberMember {
  size_t member = 0;
  size_t first = 0;
  size_t count = 0;
};

/// Maps the tensor members of a layout to images and one vector of numbers.
///
/// Threading: immutable but for assignment.
class TensorPlan {
 public:
  /// Maximum number of elements of an ndarray that is not an image.
  static constexpr int64_t kMaxArrayElements = 4096;
  /// Maximum number of pixels along a side of an image.
  static constexpr int64_t kMaxImageSide = 4096;
  /// Maximum number of numbers of all members together.
  static constexpr size_t kMaxNumbers = NumberModel::kMaxNumbers;

  TensorPlan() = default;

  /// Errors: kInvalidArgument if a member is too large, with its name, or if there is no tensor
  /// member.
  static Result<TensorPlan> create(idf::Layout layout);

  [[nodiscard]] const idf::Layout& layout() const { return layout_; }
  [[nodiscard]] const std::vector<ImageMember>& images() const { return images_; }
  [[nodiscard]] std::vector<ImageMember>& images() { return images_; }
  [[nodiscard]] const std::vector<NumberMember>& numbers() const { return numbers_; }
  [[nodiscard]] size_t number_count() const { return number_count_; }

  /// Splits a value that is to be stored.
  /// Errors: kInvalidArgument, with the path, if `value` has another layout or a whole number that
  /// no double holds (see inexact_members).
  Result<idf::SplitValue> split(const idf::Data& value) const;

  /// Returns all numbers of a value that was split by layout().
  /// Shape: [number_count()].
  [[nodiscard]] std::vector<double> read_numbers(const idf::SplitValue& value) const;

  /// Puts numbers back as the tensors of their members, rounded and clamped to their types.
  /// Shape: numbers [number_count()]; tensors one per member of the layout.
  void write_numbers(std::span<const double> numbers, std::vector<idf::NdArray>& tensors) const;

  /// Scales the quaternions in `numbers` to length one again after arithmetic has changed their
  /// length. Quaternions of length zero stay as they are.
  /// Shape: numbers [number_count()].
  void make_orientations_unit(std::span<double> numbers) const;

 private:
  idf::Layout layout_;
  std::vector<ImageMember> images_;
  std::vector<NumberMember> numbers_;
  size_t number_count_ = 0;
};

/// Returns the paths of members with whole numbers that no double holds (beyond 2^53). `parts` must
/// have this layout.
[[nodiscard]] std::vector<std::string> inexact_members(const idf::Layout& layout,
                                                       const idf::SplitValue& parts);

/// Converts the elements of an array to doubles.
[[nodiscard]] std::vector<double> to_doubles(const idf::NdArray& array);

}  // namespace engram::encoders
