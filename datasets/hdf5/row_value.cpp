// SPDX-License-Identifier: Apache-2.0
#include "datasets/hdf5/row_value.h"

#include <algorithm>
#include <cstring>

#include "ltm/codec/image_file.h"

namespace engram::datasets {

namespace {

using idf::ElementType;

constexpr std::pair<h5::Type, ElementType> kTypes[] = {
    {h5::Type::kInt8, ElementType::kInt8},       {h5::Type::kInt16, ElementType::kInt16},
    {h5::Type::kInt32, ElementType::kInt32},     {h5::Type::kInt64, ElementType::kInt64},
    {h5::Type::kUInt8, ElementType::kUInt8},     {h5::Type::kUInt16, ElementType::kUInt16},
    {h5::Type::kUInt32, ElementType::kUInt32},   {h5::Type::kUInt64, ElementType::kUInt64},
    {h5::Type::kFloat32, ElementType::kFloat32}, {h5::Type::kFloat64, ElementType::kFloat64}};

ElementType element_type(h5::Type type) {
  return std::ranges::find(kTypes, type, &std::pair<h5::Type, ElementType>::first)->second;
}

h5::Type h5_type(ElementType type) {
  return std::ranges::find(kTypes, type, &std::pair<h5::Type, ElementType>::second)->first;
}

idf::Data array_of(h5::Type type, idf::Shape shape, std::span<const std::byte> bytes) {
  // The bytes are copied to elements of eight bytes, which are aligned for every type.
  std::vector<uint64_t> aligned((bytes.size() + 7) / 8);
  if (!bytes.empty()) std::memcpy(aligned.data(), bytes.data(), bytes.size());
  auto array = idf::NdArray::create(element_type(type), std::move(shape),
                                    Buffer::take(std::move(aligned)).slice(0, bytes.size()));
  ENGRAM_CHECK(array.ok(), "{}", array.status().message());
  return *std::move(array);
}

template <typename T>
T number(std::span<const std::byte> bytes) {
  T value{};
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

idf::Data scalar(const h5::Element& element, std::span<const std::byte> bytes) {
  if (element.kind == h5::Kind::kBool) return number<uint8_t>(bytes) != 0;
  switch (element.type) {
    case h5::Type::kInt32:
      return number<int32_t>(bytes);
    case h5::Type::kInt64:
      return number<int64_t>(bytes);
    case h5::Type::kFloat32:
      return number<float>(bytes);
    case h5::Type::kFloat64:
      return number<double>(bytes);
    // IDF has no scalars of the other types; an ndarray without axes keeps the type for an export.
    default:
      return array_of(element.type, {}, bytes);
  }
}

template <typename T>
std::vector<std::byte> bytes_of(T value) {
  std::vector<std::byte> bytes(sizeof(T));
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

RowForm number_form(h5::Kind kind, h5::Type type) {
  return {{kind, type}, {}};
}

}  // namespace

std::string dtype_name(const h5::Element& element) {
  switch (element.kind) {
    case h5::Kind::kHalf:
      return "float16";
    case h5::Kind::kBool:
      return "bool";
    case h5::Kind::kText:
      return "text";
    case h5::Kind::kFixedText:
      return "fixed_text";
    case h5::Kind::kBytes:
      return "bytes";
    default:
      return std::string(idf::to_string(element_type(element.type)));
  }
}

idf::Data row_value(const h5::ArrayInfo& info, RowRole role, std::span<const std::byte> bytes) {
  ENGRAM_CHECK(bytes.size() == info.row_bytes(), "{} bytes are no row of {}", bytes.size(),
               info.row_bytes());
  if (info.shape.size() == 1) return idf::Dict{{"value", scalar(info.element, bytes)}};
  idf::Shape shape(info.shape.begin() + 1, info.shape.end());
  if (role == RowRole::kDepth && shape.size() == 2) shape.push_back(1);
  const char* member = role == RowRole::kImage   ? "image"
                       : role == RowRole::kDepth ? "depth"
                                                 : "values";
  return idf::Dict{{member, array_of(info.element.type, std::move(shape), bytes)}};
}

Result<idf::Data> compressed_row_value(std::span<const std::byte> file) {
  while (!file.empty() && file.back() == std::byte{0}) file = file.first(file.size() - 1);
  ENGRAM_ASSIGN_OR_RETURN(idf::NdArray image, ltm::decode_image_file(file));
  if (image.type() != ElementType::kUInt8)
    return invalid_argument("needs images of 8 bits, found {}", to_string(image.type()));
  return idf::Data(idf::Dict{{"image", std::move(image)}});
}

std::optional<RowForm> row_form(const idf::Data& value) {
  using h5::Kind;
  using h5::Type;
  if (value.is<bool>()) return number_form(Kind::kBool, Type::kUInt8);
  if (value.is<int32_t>()) return number_form(Kind::kNumber, Type::kInt32);
  if (value.is<int64_t>()) return number_form(Kind::kNumber, Type::kInt64);
  if (value.is<float>()) return number_form(Kind::kNumber, Type::kFloat32);
  if (value.is<double>()) return number_form(Kind::kNumber, Type::kFloat64);
  if (value.is<std::string>()) return RowForm{{Kind::kText}, {}};
  const auto* array = value.get_if<idf::NdArray>();
  if (array == nullptr) return std::nullopt;
  return RowForm{{Kind::kNumber, h5_type(array->type())},
                 {array->shape().begin(), array->shape().end()}};
}

std::vector<std::byte> row_bytes(const idf::Data& value) {
  if (const auto* flag = value.get_if<bool>()) return bytes_of(uint8_t{*flag});
  if (const auto* number = value.get_if<int32_t>()) return bytes_of(*number);
  if (const auto* number = value.get_if<int64_t>()) return bytes_of(*number);
  if (const auto* number = value.get_if<float>()) return bytes_of(*number);
  if (const auto* number = value.get_if<double>()) return bytes_of(*number);
  const auto bytes = value.get<idf::NdArray>().bytes();
  return {bytes.begin(), bytes.end()};
}

}  // namespace engram::datasets
