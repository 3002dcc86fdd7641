// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/value_row.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "ltm/core/not_a_number.h"
#include "ltm/idf/element_visit.h"
#include "ltm/prediction/rotation.h"

namespace engram::ltm {

namespace {

using idf::ElementType;
using idf::MemberKind;
using idf::NdArray;
using idf::TensorMember;

/// Marks a number in a row that was never finite. It differs from the zeros of values, which are
/// stored as positive zeros.
constexpr double kNeverKnown = -0.0;

bool is_never_known(double number) {
  return number == 0 && std::signbit(number);
}

bool is_float(ElementType type) {
  return type == ElementType::kFloat32 || type == ElementType::kFloat64;
}

size_t count_of(const TensorMember& member) {
  size_t count = 1;
  for (const int64_t size : member.shape) count *= static_cast<size_t>(size);
  return count;
}

/// The type of the part of a value at a path; nothing if the type does not know that path.
std::optional<idf::Type> type_at(const idf::Type* type, const std::string& path) {
  if (type == nullptr) return std::nullopt;
  std::optional<idf::Type> found = *type;
  if (path.empty()) return found;
  for (const std::string& name : idf::split_path(path)) {
    const std::vector<idf::Member> parts = found->parts();
    const bool is_repeated =
        found->kind() == idf::TypeKind::kList || found->kind() == idf::TypeKind::kDict;
    const auto part =
        is_repeated ? parts.begin() : std::ranges::find(parts, name, &idf::Member::name);
    if (part == parts.end()) return std::nullopt;
    found = part->type;
  }
  return found;
}

bool is_in_rows(const TensorMember& member) {
  switch (member.kind) {
    case MemberKind::kImage:
    case MemberKind::kDepth:
    case MemberKind::kPointCloud:
      return false;
    default:
      return count_of(member) <= static_cast<size_t>(ValueRow::kMaxElements);
  }
}

/// True for numbers that stand for something else, so that no engine can predict them.
bool is_copied(const TensorMember& member, const std::optional<idf::Type>& type) {
  if (member.kind == MemberKind::kBool) return true;
  return type && (type->kind() == idf::TypeKind::kIntEnum || type->kind() == idf::TypeKind::kTime);
}

std::optional<RotationForm> form_of(const TensorMember& member) {
  if (!is_float(member.type)) return std::nullopt;
  if (member.shape == idf::Shape{4}) return RotationForm::kQuaternion;
  if (member.shape == idf::Shape{3, 3}) return RotationForm::kMatrix;
  if (member.shape == idf::Shape{4, 4}) return RotationForm::kPose;
  return std::nullopt;
}

size_t numbers_in(const idf::Layout& layout) {
  size_t count = 0;
  for (const TensorMember& member : layout.members())
    if (is_in_rows(member)) count += count_of(member);
  return count;
}

/// The layout by the type or by the value alone, whichever finds more numbers.
idf::Layout layout_of(const idf::Data& value, const idf::Type* type) {
  const idf::Layout shown = idf::Layout::of(value);
  if (type == nullptr) return shown;
  const idf::Layout told = idf::Layout::of(value, *type, idf::FreeSizes::kOfValue);
  return numbers_in(told) >= numbers_in(shown) ? told : shown.with_kinds_of(told);
}

std::vector<double> doubles_of(const NdArray& array) {
  return idf::visit_element_type(array.type(), [&]<typename T>(T) {
    const auto values = array.values<T>();
    return std::vector<double>(values.begin(), values.end());
  });
}

/// Moves an element by what a prediction changed, from `from` to `to`.
template <typename T>
T moved(T last, double from, double to, double lowest, double highest) {
  if constexpr (std::is_integral_v<T>) {
    // A double cannot hold all digits of a large integer, so the change is added to the integer.
    const long double sum = static_cast<long double>(last) + static_cast<long double>(to - from);
    return static_cast<T>(std::clamp(sum,
                                     static_cast<long double>(std::numeric_limits<T>::lowest()),
                                     static_cast<long double>(std::numeric_limits<T>::max())));
  } else {
    const T rounded = static_cast<T>(to);
    if (static_cast<double>(rounded) > highest)
      return std::nextafter(rounded, std::numeric_limits<T>::lowest());
    if (static_cast<double>(rounded) < lowest)
      return std::nextafter(rounded, std::numeric_limits<T>::max());
    return rounded;
  }
}

}  // namespace

struct ValueRow::State {
  struct Part : RowMember {
    ElementType type = ElementType::kFloat64;
    std::optional<RotationForm> rotation;
    size_t turn = 0;  ///< Place of its turns in a row.
    double lowest = 0;
    double highest = 0;
  };

  idf::Layout layout;
  std::vector<Part> parts;
  std::vector<RowMember> row_members;  ///< The public part of `parts`.
  std::vector<size_t> others;
  size_t counted = 0;
  size_t elements = 0;
  size_t numbers = 0;

  void add(size_t index, const std::optional<idf::Type>& type) {
    const TensorMember& member = layout.members()[index];
    Part part{{index, elements, count_of(member), ltm::is_copied(member, type)}, member.type};
    idf::visit_element_type(member.type, [&]<typename T>(T) {
      part.lowest = static_cast<double>(std::numeric_limits<T>::lowest());
      part.highest = static_cast<double>(std::numeric_limits<T>::max());
    });
    if (const idf::Quantity* quantity = type ? type->quantity() : nullptr) {
      part.lowest = std::max(part.lowest, quantity->minimum.value_or(part.lowest));
      part.highest = std::min(part.highest, quantity->maximum.value_or(part.highest));
    }
    if (!is_float(member.type)) {
      part.lowest = std::ceil(part.lowest);
      part.highest = std::floor(part.highest);
    }
    elements += part.count;
    counted += part.is_copied ? 0 : part.count;
    parts.push_back(part);
  }

  /// Reads a rotation: it adds the turn since the row before and takes the sign of the quaternion
  /// from there. False if the elements are no rotation.
  static bool read_rotation(const Part& part, bool is_finite, std::span<const double> before,
                            std::vector<double>& elements, std::span<double> row) {
    Eigen::Map<Eigen::Vector3d> turn(row.data() + part.turn);
    turn.setZero();
    if (before.empty()) return is_finite && rotation_of(*part.rotation, elements);
    const auto held = before.subspan(part.first, part.count);
    turn = Eigen::Map<const Eigen::Vector3d>(before.data() + part.turn);
    if (!is_finite) {
      elements.assign(held.begin(), held.end());
      return true;
    }
    const auto from = rotation_of(*part.rotation, held);
    const auto to = rotation_of(*part.rotation, elements);
    if (!from || !to) return false;
    turn += turn_between(*from, *to);
    if (*part.rotation == RotationForm::kQuaternion && from->dot(*to) < 0)
      for (double& element : elements) element = -element;
    return true;
  }

  static void finish_rotation(const Part& part, std::span<const double> last,
                              std::span<double> predicted) {
    const auto before = last.subspan(part.first, part.count);
    const auto elements = predicted.subspan(part.first, part.count);
    const Eigen::Vector3d turn = Eigen::Map<const Eigen::Vector3d>(predicted.data() + part.turn) -
                                 Eigen::Map<const Eigen::Vector3d>(last.data() + part.turn);
    const std::vector<double> position(elements.begin(), elements.end());
    std::ranges::copy(before, elements.begin());
    const auto from = rotation_of(*part.rotation, before);
    const Eigen::Quaterniond to =
        from && turn.allFinite() ? turned(*from, turn) : Eigen::Quaterniond::Identity();
    if (from && turn.norm() > 0 && to.coeffs().allFinite())
      write_rotation(*part.rotation, to, elements);
    if (*part.rotation == RotationForm::kPose)
      for (const size_t at : {3, 7, 11})
        if (std::isfinite(position[at])) elements[at] = position[at];
  }

  static void finish_numbers(const Part& part, std::span<const double> last,
                             std::span<double> predicted) {
    for (size_t i = part.first; i < part.first + part.count; ++i) {
      if (part.is_copied || is_never_known(last[i]) || !std::isfinite(predicted[i]))
        predicted[i] = last[i];
      if (part.is_copied || is_never_known(last[i])) continue;
      if (!is_float(part.type)) predicted[i] = std::round(predicted[i]);
      if (part.lowest <= part.highest)
        predicted[i] = std::clamp(predicted[i], part.lowest, part.highest);
    }
  }

  static NdArray tensor_of(const Part& part, const NdArray& value, std::span<const double> last,
                           std::span<const double> predicted) {
    return idf::visit_element_type(part.type, [&]<typename T>(T) {
      const auto held = value.values<T>();
      std::vector<T> elements(held.begin(), held.end());
      bool is_changed = false;
      for (size_t i = 0; i < elements.size(); ++i) {
        const double from = last[part.first + i], to = predicted[part.first + i];
        const bool is_finite = std::isfinite(static_cast<double>(held[i]));
        if (from == to && (is_finite || is_never_known(from))) continue;
        elements[i] = moved(held[i], from, to, part.lowest, part.highest);
        is_changed = true;
      }
      if (!is_changed) return value;
      const double sign = sign_of(part, value, predicted);
      for (size_t i = 0; part.rotation && i < elements.size(); ++i)
        elements[i] = static_cast<T>(sign * predicted[part.first + i]);
      return NdArray::take(value.shape(), std::move(elements));
    });
  }

  /// The sign that makes a predicted quaternion closer to the one in the value. The row may hold
  /// the negative of the value's quaternion, as its sign never jumps.
  static double sign_of(const Part& part, const NdArray& value, std::span<const double> predicted) {
    if (part.rotation != RotationForm::kQuaternion) return 1;
    const std::vector<double> held = doubles_of(value);
    double product = 0;
    for (size_t i = 0; i < held.size(); ++i) product += held[i] * predicted[part.first + i];
    return product < 0 ? -1 : 1;
  }
};

ValueRow::ValueRow(const idf::Data& value, const idf::Type* type, bool has_rotations) {
  auto state = std::make_shared<State>();
  state->layout = layout_of(value, type);
  const auto split = state->layout.split(value);
  ENGRAM_CHECK(split.ok(), "{}", split.status().message());
  const auto& members = state->layout.members();
  for (size_t i = 0; i < members.size(); ++i) {
    if (is_in_rows(members[i]) && state->elements + count_of(members[i]) <= kMaxNumbers)
      state->add(i, type_at(type, members[i].path));
    else
      state->others.push_back(i);
  }
  state->numbers = state->elements;
  for (State::Part& part : state->parts) {
    const auto form = has_rotations ? form_of(members[part.member]) : std::nullopt;
    if (!form || !rotation_of(*form, doubles_of(split->tensors[part.member]))) continue;
    part.rotation = form;
    part.is_quaternion = *form == RotationForm::kQuaternion;
    part.turn = state->numbers;
    state->numbers += 3;
  }
  state->row_members.assign(state->parts.begin(), state->parts.end());
  state_ = std::move(state);
}

const idf::Layout& ValueRow::layout() const {
  return state_->layout;
}
const std::vector<size_t>& ValueRow::other_members() const {
  return state_->others;
}
size_t ValueRow::numbers() const {
  return state_->numbers;
}
size_t ValueRow::elements() const {
  return state_->elements;
}
size_t ValueRow::counted() const {
  return state_->counted;
}
const std::vector<RowMember>& ValueRow::row_members() const {
  return state_->row_members;
}

std::vector<std::string> ValueRow::uncounted_paths() const {
  std::vector<std::string> paths;
  for (const State::Part& part : state_->parts)
    if (part.is_copied) paths.push_back(state_->layout.members()[part.member].path);
  return paths;
}

bool ValueRow::has_continued() const {
  return std::ranges::any_of(state_->parts,
                             [](const State::Part& part) { return !part.is_copied; });
}

bool ValueRow::read(const idf::SplitValue& value, std::span<const double> before,
                    std::span<double> row) const {
  for (const State::Part& part : state_->parts) {
    std::vector<double> elements = doubles_of(value.tensors[part.member]);
    const bool is_finite =
        std::ranges::all_of(elements, [](double element) { return std::isfinite(element); });
    for (size_t i = 0; i < part.count; ++i) {
      if (!std::isfinite(elements[i]))
        elements[i] = before.empty() ? kNeverKnown : before[part.first + i];
      else if (elements[i] == 0)
        elements[i] = 0.0;
    }
    if (part.rotation && !State::read_rotation(part, is_finite, before, elements, row))
      return false;
    std::ranges::copy(elements, row.begin() + static_cast<std::ptrdiff_t>(part.first));
  }
  return true;
}

void ValueRow::finish(std::span<const double> last, std::span<double> predicted) const {
  for (const State::Part& part : state_->parts)
    if (part.rotation)
      State::finish_rotation(part, last, predicted);
    else
      State::finish_numbers(part, last, predicted);
}

namespace {

double sum_of_squares(const RowMember& member, std::span<const double> a,
                      std::span<const double> b) {
  double same = 0, opposite = 0;
  for (size_t i = member.first; i < member.first + member.count; ++i) {
    same += (a[i] - b[i]) * (a[i] - b[i]);
    opposite += (a[i] + b[i]) * (a[i] + b[i]);
  }
  return member.is_quaternion ? std::min(same, opposite) : same;
}

}  // namespace

double ValueRow::mean_square(std::span<const double> a, std::span<const double> b) const {
  double sum = 0;
  for (const RowMember& member : state_->row_members)
    if (!member.is_copied) sum += sum_of_squares(member, a, b);
  return state_->counted == 0 ? kNaN : sum / static_cast<double>(state_->counted);
}

double ValueRow::mean_square(const RowMember& member, std::span<const double> a,
                             std::span<const double> b) {
  return sum_of_squares(member, a, b) / static_cast<double>(std::max<size_t>(member.count, 1));
}

idf::Data ValueRow::value(const idf::SplitValue& value, std::span<const double> last,
                          std::span<const double> predicted) const {
  idf::SplitValue parts = value;
  for (const State::Part& part : state_->parts)
    parts.tensors[part.member] =
        State::tensor_of(part, value.tensors[part.member], last, predicted);
  auto joined = state_->layout.join(parts);
  ENGRAM_CHECK(joined.ok(), "{}", joined.status().message());
  return std::move(joined).value();
}

}  // namespace engram::ltm
