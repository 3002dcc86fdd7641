// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "ltm/idf/layout.h"
#include "ltm/idf/type.h"

namespace engram::ltm {

/// A member of a value whose elements are part of rows.
struct RowMember {
  size_t member = 0;           ///< Of the layout.
  size_t first = 0;            ///< Of its elements in a row.
  size_t count = 0;            ///< Of its elements.
  bool is_copied = false;      ///< Never continued, and counted in no error.
  bool is_quaternion = false;  ///< The negative of it is the same.
};

/// Values of one layout as rows of numbers that can be continued, and such rows as values again.
///
/// A row has the elements of all members but images, depth images, point clouds and arrays of more
/// than kMaxElements, then three numbers per rotation: how far it was turned in all, about each
/// axis, so that a body that turns evenly is a straight line, past half a turn too.
///
/// Rotations are quaternions [4], matrices [3, 3] and poses [4, 4] of floats that are one in the
/// first value; bools, times, names of numbers (IntEnum), everything that is no tensor member and
/// numbers after the first kMaxNumbers are copied from the last value.
/// Threading: immutable.
/// Source: docs/prediction.md, section "Values".
class ValueRow {
 public:
  static constexpr int64_t kMaxElements = 256;
  static constexpr size_t kMaxNumbers = 1024;

  /// Of the layout that `value` has. `type` tells bounds, kinds of arrays and lists of fixed size;
  /// may be null. Without `has_rotations` these are numbers like others.
  explicit ValueRow(const idf::Data& value, const idf::Type* type = nullptr,
                    bool has_rotations = true);

  [[nodiscard]] const idf::Layout& layout() const;

  /// Indices of the layout's members that are no part of rows: images, clouds, large arrays.
  [[nodiscard]] const std::vector<size_t>& other_members() const;

  [[nodiscard]] size_t numbers() const;   ///< Of a row.
  [[nodiscard]] size_t elements() const;  ///< Those at its front that are elements of a value.
  [[nodiscard]] size_t counted() const;   ///< Elements of members that are not only copied.
  /// The members whose elements are in rows, in the order of these.
  [[nodiscard]] const std::vector<RowMember>& row_members() const;
  [[nodiscard]] bool has_continued() const;  ///< Whether any is predicted and not copied.

  /// The row of a value of the layout; `before`: the row before it, empty where there is none. What
  /// is not finite stays as it was before. False where a rotation is none any more.
  /// Shape: row [numbers()].
  [[nodiscard]] bool read(const idf::SplitValue& value, std::span<const double> before,
                          std::span<double> row) const;

  /// Makes what was predicted from the row `last` what a value can hold: rotations, integers,
  /// numbers within their bounds, what is copied. Shape: both [numbers()].
  void finish(std::span<const double> last, std::span<double> predicted) const;

  /// Mean squared error over the elements that count; of quaternions that of the closer sign. Not a
  /// number without any. Shape: both [numbers()].
  [[nodiscard]] double mean_square(std::span<const double> a, std::span<const double> b) const;

  /// The same of one of row_members(), whether it counts or not.
  [[nodiscard]] static double mean_square(const RowMember& member, std::span<const double> a,
                                          std::span<const double> b);

  /// The value that a finished row says, predicted from `value` whose row is `last`. What did not
  /// change keeps its bits; numbers that never were finite stay as they are.
  [[nodiscard]] idf::Data value(const idf::SplitValue& value, std::span<const double> last,
                                std::span<const double> predicted) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace engram::ltm
