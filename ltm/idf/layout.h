// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/idf/data.h"

namespace engram::idf {

/// The kind of a tensor member, in addition to its element type and shape.
enum class MemberKind : uint8_t {
  kBool,    ///< A bool; its tensor is uint8 [].
  kNumber,  ///< An int32, int64, float32 or float64 scalar; shape [].
  kArray,   ///< An ndarray of fixed shape.
  kImage,   ///< An ndarray uint8 [H, W, 3] or [H, W, 1] with H, W >= 8, or uint16 [H, W, 1].
  // Kinds that only a type can tell; without a type these are arrays.
  kDepth,        ///< A depth image float32 [H, W, 1]. Unit: m.
  kPosition,     ///< The position of a pose: float32 or float64 [3]. Unit: m.
  kOrientation,  ///< A unit quaternion w, x, y, z: float32 or float64 [4].
  kPointCloud,   ///< Points float32 [N, fields]; see PointType in ltm/idf/type.h.
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

/// A value in parts: `tensors` in the order of Layout::members(), `remainder` in walk order.
struct SplitValue {
  std::vector<NdArray> tensors;
  List remainder;
};

class Type;

/// How a typed layout treats arrays whose type leaves a size free.
enum class FreeSizes {
  kRemainder,  ///< They may differ from value to value, so they are remainder.
  /// All values have the sizes of the given one, as those of a camera do.
  kOfValue,
};

/// How a value is split into tensor members and a remainder, and joined again.
///
/// Tensor members are scalars and ndarrays that are reached through dicts. Strings, absent values
/// and lists form the remainder, each as a whole, because the length of a list may vary. A type
/// refines this (see `of`).
/// Filters, columns, encoders and predictors all use this one split.
/// Threading: immutable.
/// Source: docs/design.md, section 5.
class Layout {
 public:
  /// The layout of `none`, which is a single part of the remainder.
  Layout() = default;

  /// The layout of `value`. Complexity: O(number of nodes); arrays are not read.
  static Layout of(const Data& value);

  /// The layout of values of `type`, with members in the order of `value`.
  ///
  /// A type tells more: tuples, pairs and lists of fixed size are split too, and images, rotations
  /// and clouds have their kind. Parts that may differ from value to value are remainder, each as a
  /// whole: optional members, dicts, lists and (see `free_sizes`) arrays of free size. Where
  /// `value` is not of its type, the layout is that of the value itself.
  static Layout of(const Data& value, const Type& type,
                   FreeSizes free_sizes = FreeSizes::kRemainder);

  /// This layout with the kinds of `other`, where both have a member of the same path, element type
  /// and shape. Thus a type adds its knowledge of arrays without moving any member to the
  /// remainder.
  [[nodiscard]] Layout with_kinds_of(const Layout& other) const;

  /// This layout with the members at `paths` in the remainder.
  [[nodiscard]] Layout with_remainder(const std::vector<std::string>& paths) const;

  /// Reads what to_data wrote.
  /// Errors: kDataLoss.
  static Result<Layout> from_data(const Data& data);

  /// The layout as a value, to be stored with the data that it describes.
  [[nodiscard]] const Data& to_data() const { return skeleton_; }

  [[nodiscard]] const std::vector<TensorMember>& members() const& { return members_; }
  /// The members of a temporary would dangle in a loop.
  void members() && = delete;

  /// Splits `value`; arrays are shared, not copied.
  /// Errors: kInvalidArgument naming the path where `value` has another layout.
  Result<SplitValue> split(const Data& value) const;

  /// Joins parts to the identical value.
  /// Errors: kInvalidArgument where the tensors or the remainder are not of this layout.
  Result<Data> join(const SplitValue& parts) const;

  friend bool operator==(const Layout& a, const Layout& b) { return a.skeleton_ == b.skeleton_; }

 private:
  // The structure of the value: dicts as they are, a tensor member as the list [kind, element type,
  // size...], a list that is split as ["list", place...], and a part of the remainder as none, or
  // as "any" where a type put a tensor or a dict there.
  explicit Layout(Data skeleton) : skeleton_(std::move(skeleton)) {}

  Data skeleton_;
  std::vector<TensorMember> members_;
};

}  // namespace engram::idf
