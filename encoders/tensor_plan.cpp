// SPDX-License-Identifier: Apache-2.0
#include "encoders/tensor_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace engram::encoders {

namespace {

/// Calls visit with a value of the C++ type of `type`.
template <typename Visit>
auto visit_type(idf::ElementType type, Visit visit) {
  switch (type) {
    case idf::ElementType::kInt8:
      return visit(int8_t{});
    case idf::ElementType::kInt16:
      return visit(int16_t{});
    case idf::ElementType::kInt32:
      return visit(int32_t{});
    case idf::ElementType::kInt64:
      return visit(int64_t{});
    case idf::ElementType::kUInt8:
      return visit(uint8_t{});
    case idf::ElementType::kUInt16:
      return visit(uint16_t{});
    case idf::ElementType::kUInt32:
      return visit(uint32_t{});
    case idf::ElementType::kUInt64:
      return visit(uint64_t{});
    case idf::ElementType::kFloat32:
      return visit(float{});
    case idf::ElementType::kFloat64:
      break;
  }
  return visit(double{});
}

template <typename T>
T nearest(double value) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(value);
  } else {
    using Limits = std::numeric_limits<T>;
    if (std::isnan(value)) return 0;
    const double rounded = std::nearbyint(value);
    if (rounded <= static_cast<double>(Limits::min())) return Limits::min();
    if (rounded >= static_cast<double>(Limits::max())) return Limits::max();
    return static_cast<T>(rounded);
  }
}

/// Whether doubles hold this whole number and all smaller ones.
template <typename T>
bool is_double(T value) {
  constexpr int64_t kLargest = int64_t{1} << 53;
  return std::cmp_less_equal(value, kLargest) && std::cmp_greater_equal(value, -kLargest);
}

bool is_too_large(const idf::TensorMember& member) {
  int64_t count = 1;
  for (const int64_t size : member.shape) {
    // Each size is checked before it is multiplied, so that the product cannot overflow.
    if (size > TensorPlan::kMaxArrayElements) return true;
    count *= size;
    if (count > TensorPlan::kMaxArrayElements) return true;
  }
  return false;
}

idf::NdArray array_of(const idf::TensorMember& member, bool is_bool,
                      std::span<const double> numbers) {
  return visit_type(member.type, [&]<typename T>(T) {
    std::vector<T> values;
    values.reserve(numbers.size());
    for (const double number : numbers)
      values.push_back(is_bool ? static_cast<T>(number >= 0.5) : nearest<T>(number));
    return idf::NdArray::take<T>(member.shape, std::move(values));
  });
}

}  // namespace

std::vector<std::string> inexact_members(const idf::Layout& layout, const idf::SplitValue& parts) {
  std::vector<std::string> paths;
  for (size_t i = 0; i < parts.tensors.size(); ++i) {
    const idf::NdArray& tensor = parts.tensors[i];
    const bool is_inexact = visit_type(tensor.type(), [&]<typename T>(T) {
      if constexpr (!std::is_integral_v<T> || sizeof(T) < sizeof(int64_t))
        return false;
      else
        return std::ranges::any_of(tensor.values<T>(), [](T value) { return !is_double(value); });
    });
    if (is_inexact) paths.push_back(layout.members()[i].path);
  }
  return paths;
}

std::vector<double> to_doubles(const idf::NdArray& array) {
  return visit_type(array.type(), [&]<typename T>(T) {
    const auto values = array.values<T>();
    return std::vector<double>(values.begin(), values.end());
  });
}

Result<TensorPlan> TensorPlan::create(idf::Layout layout) {
  TensorPlan plan;
  for (size_t i = 0; i < layout.members().size(); ++i) {
    const idf::TensorMember& member = layout.members()[i];
    if (member.kind == idf::MemberKind::kImage) {
      if (member.shape.size() != 3 || member.shape[0] < 8 || member.shape[1] < 8 ||
          member.shape[0] > kMaxImageSide || member.shape[1] > kMaxImageSide ||
          (member.shape[2] != 1 && member.shape[2] != 3))
        return invalid_argument("image member '{}': found size {}, needs [8..{}, 8..{}, 1 or 3]",
                                member.path, idf::to_string(member.shape), kMaxImageSide,
                                kMaxImageSide);
      plan.images_.push_back({i, static_cast<int>(member.shape[0]),
                              static_cast<int>(member.shape[1]), static_cast<int>(member.shape[2]),
                              1.0, member.type == idf::ElementType::kUInt16});
      continue;
    }
    if (is_too_large(member))
      return invalid_argument("member '{}': found an array {}, a model takes {} elements at most",
                              member.path, idf::to_string(member.shape), kMaxArrayElements);
    size_t count = 1;
    for (const int64_t size : member.shape) count *= static_cast<size_t>(size);
    plan.numbers_.push_back({i, plan.number_count_, count});
    plan.number_count_ += count;
  }
  if (plan.number_count_ > kMaxNumbers)
    return invalid_argument("layout: found {} numbers, a model takes {} at most",
                            plan.number_count_, kMaxNumbers);
  if (plan.images_.empty() && plan.number_count_ == 0)
    return invalid_argument("layout: found no image and no number, a model needs at least one");
  plan.layout_ = std::move(layout);
  return plan;
}

Result<idf::SplitValue> TensorPlan::split(const idf::Data& value) const {
  ENGRAM_ASSIGN_OR_RETURN(idf::SplitValue parts, layout_.split(value));
  if (const auto inexact = inexact_members(layout_, parts); !inexact.empty())
    return invalid_argument(
        "member '{}': found a whole number beyond 2^53, needs one that a double holds",
        inexact.front());
  return parts;
}

std::vector<double> TensorPlan::read_numbers(const idf::SplitValue& value) const {
  std::vector<double> numbers;
  numbers.reserve(number_count_);
  for (const NumberMember& number : numbers_) {
    const std::vector<double> values = to_doubles(value.tensors[number.member]);
    numbers.insert(numbers.end(), values.begin(), values.end());
  }
  return numbers;
}

void TensorPlan::write_numbers(std::span<const double> numbers,
                               std::vector<idf::NdArray>& tensors) const {
  ENGRAM_CHECK(numbers.size() == number_count_, "{} numbers", numbers.size());
  for (const NumberMember& number : numbers_) {
    const idf::TensorMember& member = layout_.members()[number.member];
    tensors[number.member] = array_of(member, member.kind == idf::MemberKind::kBool,
                                      numbers.subspan(number.first, number.count));
  }
}

void TensorPlan::make_orientations_unit(std::span<double> numbers) const {
  for (const NumberMember& number : numbers_) {
    if (layout_.members()[number.member].kind != idf::MemberKind::kOrientation) continue;
    const auto q = numbers.subspan(number.first, number.count);
    double squared = 0;
    for (const double part : q) squared += part * part;
    // Zero has no direction, and NaN or infinity must not spread to the other parts.
    if (!(squared > 0) || !std::isfinite(squared)) continue;
    for (double& part : q) part /= std::sqrt(squared);
  }
}

}  // namespace engram::encoders
