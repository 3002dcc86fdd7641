// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ltm/idf/layout.h"
#include "ltm/idf/type.h"

namespace engram::ltm {

/// A member of a value whose elements are part of rows.
struct RowMember {
  size_t member = 0;           ///< Index into the layout's members.
  size_t first = 0;            ///< Place of its first element in a row.
  size_t count = 0;            ///< Number of its elements.
  bool is_copied = false;      ///< It is never predicted and counts in no error.
  bool is_quaternion = false;  ///< A quaternion and its negative are equal.
};

/// Converts values of one layout to rows of numbers that engines can predict, and rows to values.
///
/// A row has the elements of all members except images, depth images, point clouds and arrays of
/// more than kMaxElements. Then it has three numbers per rotation: the total turn about each axis.
/// So a body that turns at a constant rate gives a straight line, also beyond half a turn.
///
/// Rotations are quaternions [4], matrices [3, 3] and poses [4, 4] of floats that are rotations in
/// the first value. Bools, times, named numbers (IntEnum), everything that is not a tensor member,
/// and numbers after the first kMaxNumbers are copied from the last value.
/// Threading: immutable.
/// Source: docs/prediction.md, section "Values".
class ValueRow {
 public:
  static constexpr int64_t kMaxElements = 256;
  static constexpr size_t kMaxNumbers = 1024;

  /// Takes the layout from `value`. `type` may be null; it gives bounds, kinds of arrays and lists
  /// of fixed size. If `has_rotations` is false, rotations are treated as plain numbers.
  explicit ValueRow(const idf::Data& value, const idf::Type* type = nullptr,
                    bool has_rotations = true);

  [[nodiscard]] const idf::Layout& layout() const;

  /// Indices of the layout's members that are not part of rows: images, clouds, large arrays.
  [[nodiscard]] const std::vector<size_t>& other_members() const;

  /// Numbers in a row.
  [[nodiscard]] size_t numbers() const;
  /// Numbers at the front of a row that are elements of a value; turns come after them.
  [[nodiscard]] size_t elements() const;
  /// Elements in rows whose members are predicted and not only copied.
  [[nodiscard]] size_t counted() const;
  /// The members whose elements are in rows, in the order of their elements.
  [[nodiscard]] const std::vector<RowMember>& row_members() const;
  /// Paths of the members in rows that are only ever copied and count in no error.
  [[nodiscard]] std::vector<std::string> uncounted_paths() const;
  /// True if a member in rows is predicted and not only copied.
  [[nodiscard]] bool has_continued() const;

  /// Reads a value of the layout into a row. `before` is the row before it, or empty. A number that
  /// is not finite keeps its value in `before`. False if a rotation of the first value is no longer
  /// a rotation. Shape: row [numbers()].
  [[nodiscard]] bool read(const idf::SplitValue& value, std::span<const double> before,
                          std::span<double> row) const;

  /// Makes a row that was predicted from the row `last` valid for a value: it turns rotations,
  /// rounds integers, keeps numbers within their bounds and copies what is only copied.
  /// Shape: both [numbers()].
  void finish(std::span<const double> last, std::span<double> predicted) const;

  /// Mean squared error over the elements that count; for quaternions that of the closer sign. NaN
  /// if no element counts. Shape: both [numbers()].
  [[nodiscard]] double mean_square(std::span<const double> a, std::span<const double> b) const;

  /// The same error for one of row_members(), whether it counts or not.
  [[nodiscard]] static double mean_square(const RowMember& member, std::span<const double> a,
                                          std::span<const double> b);

  /// Converts a finished row, predicted from `value` whose row is `last`, to a value. Elements that
  /// did not change keep their bits; numbers that were never finite stay as they are.
  [[nodiscard]] idf::Data value(const idf::SplitValue& value, std::span<const double> last,
                                std::span<const double> predicted) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace engram::ltm
