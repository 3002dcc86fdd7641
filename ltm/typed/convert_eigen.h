// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "ltm/typed/convert.h"
#include "ltm/typed/pose.h"

namespace engram::typed {

/// The array of a value where it has these elements and this shape, otherwise null; -1 is any size.
template <typename T>
[[nodiscard]] const idf::NdArray* find_array(const idf::Data& data,
                                             std::initializer_list<int64_t> shape) {
  const auto* array = data.get_if<idf::NdArray>();
  if (array == nullptr || array->type() != idf::kElementTypeOf<T> || array->rank() != shape.size())
    return nullptr;
  auto size = array->shape().begin();
  for (const int64_t needed : shape)
    if (const int64_t found = *size++; needed != idf::kFreeSize && needed != found) return nullptr;
  return array;
}

/// Shape: [rows, cols]. The numbers are copied: an ndarray is row-major, and a matrix seldom is.
template <typename T, int kRows, int kCols, int kOptions, int kMaxRows, int kMaxCols>
struct Convert<Eigen::Matrix<T, kRows, kCols, kOptions, kMaxRows, kMaxCols>> {
  using Matrix = Eigen::Matrix<T, kRows, kCols, kOptions, kMaxRows, kMaxCols>;
  // Eigen has no row-major column vectors and no column-major row vectors; for these both orders
  // are the same.
  using RowMajor =
      Eigen::Matrix<T, kRows, kCols, kCols == 1 && kRows != 1 ? Eigen::ColMajor : Eigen::RowMajor>;

  static idf::Data write(const Matrix& value, const idf::Type&) {
    std::vector<T> values(static_cast<size_t>(value.size()));
    Eigen::Map<RowMajor>(values.data(), value.rows(), value.cols()) = value;
    return idf::NdArray::take<T>({value.rows(), value.cols()}, std::move(values));
  }

  static bool read(const idf::Data& data, const idf::Type& type, Matrix& value) {
    const auto* needed = type.get_if<idf::types::Matrix>();
    if (needed == nullptr) return false;
    const idf::NdArray* array = find_array<T>(data, {needed->rows, needed->cols});
    if (array == nullptr) return false;
    value =
        Eigen::Map<const RowMajor>(array->values<T>().data(), array->shape()[0], array->shape()[1]);
    return true;
  }

  static bool equal(const Matrix& a, const Matrix& b) {
    if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
    return a.size() == 0 ||
           std::memcmp(a.data(), b.data(), static_cast<size_t>(a.size()) * sizeof(T)) == 0;
  }
};

/// Shape: [4], w x y z.
template <typename T, int kOptions>
struct Convert<Eigen::Quaternion<T, kOptions>> {
  using Quaternion = Eigen::Quaternion<T, kOptions>;

  static idf::Data write(const Quaternion& value, const idf::Type&) {
    return idf::NdArray::take<T>({4}, {value.w(), value.x(), value.y(), value.z()});
  }

  static bool read(const idf::Data& data, const idf::Type&, Quaternion& value) {
    const idf::NdArray* array = find_array<T>(data, {4});
    if (array == nullptr) return false;
    const std::span<const T> wxyz = array->values<T>();
    value = Quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    return true;
  }

  static bool equal(const Quaternion& a, const Quaternion& b) {
    return std::memcmp(a.coeffs().data(), b.coeffs().data(), 4 * sizeof(T)) == 0;
  }
};

/// The value is a dict {position, orientation}.
template <typename T>
struct Convert<Pose<T>> {
  static idf::Data write(const Pose<T>& value, const idf::Type& type) {
    const Eigen::Matrix<T, 3, 1>& at = value.position;
    idf::Dict dict;
    dict.reserve(2);
    dict.append_unique(std::string(idf::kPositionKey),
                       idf::NdArray::take<T>({3}, {at.x(), at.y(), at.z()}));
    dict.append_unique(std::string(idf::kOrientationKey), typed::write(value.orientation, type));
    return dict;
  }

  static bool read(const idf::Data& data, const idf::Type& type, Pose<T>& value) {
    const auto* dict = data.get_if<idf::Dict>();
    if (dict == nullptr) return false;
    const idf::Data* position = find_member(*dict, 0, idf::kPositionKey);
    const idf::Data* orientation = find_member(*dict, 1, idf::kOrientationKey);
    if (position == nullptr || orientation == nullptr) return false;
    const idf::NdArray* at = find_array<T>(*position, {3});
    if (at == nullptr) return false;
    value.position = Eigen::Map<const Eigen::Matrix<T, 3, 1>>(at->values<T>().data());
    return typed::read(*orientation, type, value.orientation);
  }

  static bool equal(const Pose<T>& a, const Pose<T>& b) {
    return std::memcmp(a.position.data(), b.position.data(), 3 * sizeof(T)) == 0 &&
           typed::equal(a.orientation, b.orientation);
  }
};

}  // namespace engram::typed
