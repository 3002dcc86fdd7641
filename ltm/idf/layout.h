// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/idf/data.h"

namespace engram::idf {

/// What a tensor member is, beyond its element type and shape.
enum class MemberKind : uint8_t {
  kBool,    ///< A bool; as tensor uint8 [].
  kNumber,  ///< An int32, int64, float32 or float64 scalar; shape [].
  kArray,   ///< An ndarray of fixed shape.
  kImage,   ///< An ndarray uint8 [H, W, 3] or [H, W, 1] with H, W >= 8, or uint16 [H, W, 1].
};

[[nodiscard]] std::string_view to_string(MemberKind kind);

/// A part of a value that is a tensor of the same type and shape in every value of one layout.
struct TensorMember {
  std::string path;
  MemberKind kind = MemberKind::kNumber;
  ElementType type = ElementType::kFloat64;
  Shape shape;

  friend bool operator==(const TensorMember&, const TensorMember&) = default;
};

/// A value taken apart: `tensors` in the order of Layout::members(), `remainder` in walk order.
struct SplitValue {
  std::vector<NdArray> tensors;
  List remainder;
};

/// How a value splits into tensor members and a remainder, and joins again.
///
/// Tensor members are scalars and ndarrays that are reached through dicts. Strings, absent
/// values and lists are the remainder, each whole: the length of a list may vary.
/// Filters, columns, encoders and predictors all use this one split.
/// Threading: immutable.
/// Source: docs/design.md, section 5.
class Layout {
 public:
  /// The layout of `none`: one place of the remainder.
  Layout() = default;

  /// The layout that `value` has. Complexity: O(number of nodes); arrays are not read.
  static Layout of(const Data& value);

  /// Reads what to_data wrote.
  /// Errors: kDataLoss.
  static Result<Layout> from_data(const Data& data);

  /// The layout itself as a value, to be stored with what was made with it.
  [[nodiscard]] const Data& to_data() const { return skeleton_; }

  [[nodiscard]] const std::vector<TensorMember>& members() const& { return members_; }
  /// The members of a temporary would dangle in a loop.
  void members() && = delete;

  /// Takes `value` apart; arrays are shared, not copied.
  /// Errors: kInvalidArgument naming the path where `value` has another layout.
  Result<SplitValue> split(const Data& value) const;

  /// The identical value again.
  /// Errors: kInvalidArgument where the tensors or the remainder are not of this layout.
  Result<Data> join(const SplitValue& parts) const;

  friend bool operator==(const Layout& a, const Layout& b) { return a.skeleton_ == b.skeleton_; }

 private:
  // The shape of the value: dicts as they are, a tensor member as the list [kind, element type,
  // size...], a place of the remainder as none.
  explicit Layout(Data skeleton) : skeleton_(std::move(skeleton)) {}

  Data skeleton_;
  std::vector<TensorMember> members_;
};

}  // namespace engram::idf
