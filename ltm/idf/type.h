// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/idf/media_type.h"

namespace engram::idf {

/// The size of an axis or list that may differ from value to value.
inline constexpr int64_t kFreeSize = -1;

/// The bound of nested types.
inline constexpr int kMaxTypeDepth = 64;

/// The meaning and the bounds of the numbers of a type. Bounds are inclusive and apply to every
/// element of an ndarray; with a bound, NaN and infinities are out of bounds.
struct Quantity {
  std::string unit;  ///< "m", "rad", "N"; empty where it is unknown.
  std::optional<double> minimum = std::nullopt;
  std::optional<double> maximum = std::nullopt;

  [[nodiscard]] bool is_bounded() const { return minimum || maximum; }

  friend bool operator==(const Quantity&, const Quantity&) = default;
};

/// In the order of the alternatives of TypeValue. The names of to_string are stored, never these
/// numbers.
enum class TypeKind : uint8_t {
  kInt,
  kLong,
  kFloat,
  kDouble,
  kString,
  kBool,
  kTime,
  kMemoryLink,
  kIntEnum,
  kNdArray,
  kMatrix,
  kQuaternion,
  kOrientation,
  kPose,
  kImage,
  kPointCloud,
  kList,
  kTuple,
  kDict,
  kObject,
  kPair,
};

/// The names of the XML elements: "Int", "Long", "MemoryLink", "NDArray", ...
[[nodiscard]] std::string_view to_string(TypeKind kind);

namespace types {
struct Int;
struct Long;
struct Float;
struct Double;
struct String;
struct Bool;
struct Time;
struct MemoryLink;
struct IntEnum;
struct NdArray;
struct Matrix;
struct Quaternion;
struct Orientation;
struct Pose;
struct Image;
struct PointCloud;
struct List;
struct Tuple;
struct Dict;
struct Object;
struct Pair;
}  // namespace types

/// The content of a type besides being optional and documented; visit it with std::visit.
using TypeValue = std::variant<types::Int, types::Long, types::Float, types::Double, types::String,
                               types::Bool, types::Time, types::MemoryLink, types::IntEnum,
                               types::NdArray, types::Matrix, types::Quaternion, types::Orientation,
                               types::Pose, types::Image, types::PointCloud, types::List,
                               types::Tuple, types::Dict, types::Object, types::Pair>;

struct EnumValue;
struct Member;
struct ArrayType;

/// Describes a set of IDF values and their meaning. Copying is O(1).
///
/// The values of each kind:
///
/// | type | value |
/// |---|---|
/// | Int, Long, Float, Double | int32, int64, float32, float64 |
/// | String, Bool | string, bool |
/// | Time | int64, ns since the Unix epoch, UTC |
/// | MemoryLink | string, the printed MemoryId; empty: no link |
/// | IntEnum | int32, one of the named values |
/// | NDArray, Matrix | ndarray of the shape; a matrix is [rows, cols] |
/// | Quaternion | ndarray float32 or float64 [4]: w, x, y, z |
/// | Orientation | the same with norm 1 (within 1e-3) |
/// | Pose | dict {position: ndarray [3], orientation: ndarray [4]} |
/// | Image, PointCloud | ndarray as PixelType and PointType say |
/// | List | list |
/// | Tuple, Pair | list of exactly that many elements |
/// | Dict | dict of any keys, all values of one type |
/// | Object | dict with exactly its members, in any order |
/// | any optional | none where absent; the key of an absent member is present |
///
/// A pose is two arrays and not one matrix: metres and rotations differ in scale and error bound,
/// each becomes a tensor member of its own, seven numbers cannot contradict each other as sixteen
/// can, and `pose/position` can be addressed.
/// Frame: Hamilton quaternions; `pose_world_camera` transforms camera coordinates to world:
/// p_world = orientation * p_camera + position.
///
/// The factories are for types written in code: they abort where create would fail (checked). Types
/// do not contain themselves.
/// Threading: immutable.
/// Source: docs/idf.md.
class Type {
 public:
  static Type int32(Quantity quantity = {});
  static Type int64(Quantity quantity = {});
  static Type float32(Quantity quantity = {});
  static Type float64(Quantity quantity = {});
  static Type string();
  static Type boolean();
  static Type time();
  static Type memory_link();
  /// Needs at least one value; names and values must be unique.
  static Type int_enum(std::string name, std::vector<EnumValue> values);
  /// `shape` gives the rank; kFreeSize for an axis of any size.
  static Type ndarray(ElementType element, Shape shape, Quantity quantity = {});
  static Type ndarray_of_rank(ElementType element, size_t rank, Quantity quantity = {});
  static Type matrix(int64_t rows, int64_t cols, ElementType element = ElementType::kFloat32,
                     Quantity quantity = {});
  /// `element` is float32 or float64.
  static Type quaternion(ElementType element = ElementType::kFloat32);
  static Type orientation(ElementType element = ElementType::kFloat32);
  static Type pose(ElementType element = ElementType::kFloat32);
  static Type image(PixelType pixel, int64_t height = kFreeSize, int64_t width = kFreeSize);
  static Type point_cloud(PointType point, int64_t count = kFreeSize);
  static Type list(const Type& element, int64_t size = kFreeSize);
  static Type tuple(std::vector<Type> elements);
  static Type dict(const Type& element);
  static Type pair(const Type& first, const Type& second);
  /// The members of `base` come first; member names must be unique.
  static Type object(std::string name, std::vector<Member> own_members,
                     std::optional<Type> base = std::nullopt);

  /// Creates any type.
  /// Errors: kInvalidArgument naming the type and what does not fit: names, bounds that no value
  /// meets, sizes, a default value above 1 GiB or 2^20 nodes, more than kMaxTypeDepth levels.
  static Result<Type> create(TypeValue value, bool is_optional = false, std::string doc = "");

  /// The same type, but optional or required.
  [[nodiscard]] Type optional() const { return with_optional(true); }
  [[nodiscard]] Type required() const { return with_optional(false); }
  [[nodiscard]] Type with_optional(bool is_optional) const;
  [[nodiscard]] Type with_doc(std::string doc) const;

  [[nodiscard]] TypeKind kind() const;
  [[nodiscard]] bool is_optional() const;
  /// The documentation that people wrote; may be empty.
  [[nodiscard]] const std::string& doc() const;
  [[nodiscard]] const TypeValue& value() const;

  /// Null if this is not a T, as in `type.get_if<types::Object>()`.
  template <typename T>
  [[nodiscard]] const T* get_if() const;

  /// Aborts if this is not a T; for types whose kind was checked before.
  template <typename T>
  [[nodiscard]] const T& get() const;

  /// The name of an Object or IntEnum, otherwise empty.
  [[nodiscard]] std::string_view name() const;

  /// The unit and bounds of a numeric type; null for other types.
  [[nodiscard]] const Quantity* quantity() const;

  /// The array type of a value of this type; nothing where such a value is no ndarray.
  [[nodiscard]] std::optional<ArrayType> as_array() const;

  /// The types directly inside: the elements of a list, tuple, dict or pair; all members of an
  /// object; position and orientation of a pose. Their names are "0", "1", ... or those of the
  /// members, and empty for the elements of a list or dict.
  [[nodiscard]] std::vector<Member> parts() const;

  /// The levels of nested types, one for a scalar.
  [[nodiscard]] int depth() const;

  /// The number of types that a value of this type needs, itself included, with every element of
  /// lists of fixed size.
  [[nodiscard]] size_t node_count() const;

  /// True where everything is equal, documentation included.
  friend bool operator==(const Type& a, const Type& b);

 private:
  struct Node;
  explicit Type(std::shared_ptr<const Node> node) : node_(std::move(node)) {}

  std::shared_ptr<const Node> node_;
};

struct EnumValue {
  std::string name;
  int32_t value = 0;
  std::string doc = "";

  friend bool operator==(const EnumValue&, const EnumValue&) = default;
};

/// A named type inside an object, with the documentation of this use.
struct Member {
  std::string name;
  Type type;
  std::string doc = "";

  friend bool operator==(const Member&, const Member&) = default;
};

/// The element type and shape of an ndarray; kFreeSize for an axis of any size.
struct ArrayType {
  ElementType element = ElementType::kFloat32;
  Shape shape;

  /// True where no axis is free.
  [[nodiscard]] bool is_fixed() const;
  [[nodiscard]] bool admits(const Shape& found) const;

  friend bool operator==(const ArrayType&, const ArrayType&) = default;
};

/// The alternatives of TypeValue.
namespace types {
struct Int {
  Quantity quantity;
  friend bool operator==(const Int&, const Int&) = default;
};
struct Long {
  Quantity quantity;
  friend bool operator==(const Long&, const Long&) = default;
};
struct Float {
  Quantity quantity;
  friend bool operator==(const Float&, const Float&) = default;
};
struct Double {
  Quantity quantity;
  friend bool operator==(const Double&, const Double&) = default;
};
struct String {
  friend bool operator==(const String&, const String&) = default;
};
struct Bool {
  friend bool operator==(const Bool&, const Bool&) = default;
};
struct Time {
  friend bool operator==(const Time&, const Time&) = default;
};
struct MemoryLink {
  friend bool operator==(const MemoryLink&, const MemoryLink&) = default;
};
struct IntEnum {
  std::string name;
  std::vector<EnumValue> values;

  /// Null where no name has this value.
  [[nodiscard]] const EnumValue* find(int32_t value) const;

  friend bool operator==(const IntEnum&, const IntEnum&) = default;
};
struct NdArray {
  ElementType element = ElementType::kFloat32;
  Shape shape;
  Quantity quantity;
  friend bool operator==(const NdArray&, const NdArray&) = default;
};
struct Matrix {
  int64_t rows = kFreeSize;
  int64_t cols = kFreeSize;
  ElementType element = ElementType::kFloat32;
  Quantity quantity;
  friend bool operator==(const Matrix&, const Matrix&) = default;
};
struct Quaternion {
  ElementType element = ElementType::kFloat32;
  friend bool operator==(const Quaternion&, const Quaternion&) = default;
};
struct Orientation {
  ElementType element = ElementType::kFloat32;
  friend bool operator==(const Orientation&, const Orientation&) = default;
};
struct Pose {
  ElementType element = ElementType::kFloat32;
  friend bool operator==(const Pose&, const Pose&) = default;
};
struct Image {
  PixelType pixel = PixelType::kRgb24;
  int64_t height = kFreeSize;
  int64_t width = kFreeSize;
  friend bool operator==(const Image&, const Image&) = default;
};
struct PointCloud {
  PointType point = PointType::kXyz;
  int64_t count = kFreeSize;
  friend bool operator==(const PointCloud&, const PointCloud&) = default;
};
struct List {
  Type element;
  int64_t size = kFreeSize;
  friend bool operator==(const List&, const List&) = default;
};
struct Tuple {
  std::vector<Type> elements;
  friend bool operator==(const Tuple&, const Tuple&) = default;
};
struct Dict {
  Type element;
  friend bool operator==(const Dict&, const Dict&) = default;
};
struct Object {
  std::string name;
  std::vector<Member> own_members;
  std::optional<Type> base;
  /// The members of the base, then the own ones; filled by Type::create.
  std::vector<Member> members;

  /// Null where there is no such member.
  [[nodiscard]] const Member* find(std::string_view member) const;

  friend bool operator==(const Object& a, const Object& b) {
    return a.name == b.name && a.own_members == b.own_members && a.base == b.base;
  }
};
struct Pair {
  Type first;
  Type second;
  friend bool operator==(const Pair&, const Pair&) = default;
};
}  // namespace types

/// The keys of the dict of a pose.
inline constexpr std::string_view kPositionKey = "position";
inline constexpr std::string_view kOrientationKey = "orientation";

template <typename T>
const T* Type::get_if() const {
  return std::get_if<T>(&value());
}

template <typename T>
const T& Type::get() const {
  const T* found = get_if<T>();
  ENGRAM_CHECK(found != nullptr, "type is {}", to_string(kind()));
  return *found;
}

/// The type that a value shows by itself. A list with elements of one type is a List, others a
/// Tuple; arrays have their shape; a dict is an Object without a name, and `none` an optional
/// String.
/// Errors: kInvalidArgument where the value is deeper or larger than types may be.
Result<Type> type_of(const Data& data);

enum class TypeText { kOneLine, kLines };

/// Prints "kitchen::Cup{pose: Pose<float32>, height: optional Float[m, 0..1]}". With kLines each
/// member has a line, followed by its documentation.
[[nodiscard]] std::string to_string(const Type& type, TypeText form = TypeText::kOneLine);

/// The type as a value, to be stored with the data that it describes: a flat table in which equal
/// types appear once. Source: docs/idf.md, section "Types as values".
[[nodiscard]] Data to_data(const Type& type);

/// Reads what to_data wrote; safe on hostile values.
/// Errors: kDataLoss naming the entry of the table, what was found and what was needed.
Result<Type> type_from_data(const Data& data);

}  // namespace engram::idf
