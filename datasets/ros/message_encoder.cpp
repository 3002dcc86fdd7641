// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "datasets/ros/message_coding.h"
#include "ltm/idf/convert_elements.h"
#include "ltm/idf/element_visit.h"

namespace engram::datasets::ros {

namespace {

/// Converts a scalar, or an ndarray of one element without axes, to another type of number.
template <typename T>
std::optional<T> number_as(const idf::Data& value) {
  const auto convert = [](auto from) -> std::optional<T> {
    if constexpr (std::is_arithmetic_v<decltype(from)> && !std::is_same_v<decltype(from), bool>) {
      const auto converted = idf::convert_number<T>(from);
      // Only exact conversions are allowed, so that a message never holds another number.
      if (converted && converted->is_exact) return converted->value;
    }
    return std::nullopt;
  };
  if (const auto* array = value.get_if<idf::NdArray>()) {
    if (array->rank() != 0) return std::nullopt;
    return idf::visit_element_type(
        array->type(), [&]<typename E>(E) { return convert(array->values<E>().front()); });
  }
  if (const auto* from = value.get_if<bool>()) return static_cast<T>(*from);
  if (const auto* from = value.get_if<int32_t>()) return convert(*from);
  if (const auto* from = value.get_if<int64_t>()) return convert(*from);
  if (const auto* from = value.get_if<float>()) return convert(*from);
  if (const auto* from = value.get_if<double>()) return convert(*from);
  return std::nullopt;
}

class Encoder {
 public:
  Encoder(const MessageDefinition& definition, Serialization serialization)
      : definition_(definition), is_cdr_(serialization == Serialization::kCdr) {}

  Result<std::vector<std::byte>> encode(const idf::Data& value) {
    if (is_cdr_) out_ = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
    ENGRAM_RETURN_IF_ERROR(put_message(definition_.root(), value));
    return std::move(out_);
  }

 private:
  void align(size_t size) {
    if (!is_cdr_ || size < 2) return;
    while ((out_.size() - kEncapsulationBytes) % size != 0) out_.push_back(std::byte{0});
  }

  void put_bytes(std::span<const std::byte> bytes) {
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }

  template <typename T>
  void put(T value) {
    align(sizeof(T));
    put_bytes(std::as_bytes(std::span(&value, 1)));
  }

  template <typename T>
  Status put_number(const idf::Data& value) {
    const auto number = number_as<T>(value);
    if (!number) return wrong(value, fmt::format("a number of {} bytes that it fits", sizeof(T)));
    put(*number);
    return {};
  }

  static Status wrong(const idf::Data& value, std::string_view needed) {
    return invalid_argument("is {}, needs {}", value.kind_name(), needed);
  }

  Status put_count(size_t count) {
    if (count > std::numeric_limits<uint32_t>::max())
      return invalid_argument("has {} elements, needs fewer than 2^32", count);
    put(static_cast<uint32_t>(count));
    return {};
  }

  Status put_message(const Message& message, const idf::Data& value) {
    const auto* dict = value.get_if<idf::Dict>();
    if (dict == nullptr) return wrong(value, fmt::format("a dict of {}", message.name));
    for (const auto& [name, member] : *dict)
      if (std::ranges::find(message.fields, name, &Field::name) == message.fields.end())
        return invalid_argument("'{}': {} has no such field", name, message.name);
    for (const Field& field : message.fields) {
      const idf::Data* member = dict->find(field.name);
      if (member == nullptr) return invalid_argument("needs '{}' of {}", field.name, message.name);
      if (const Status status = put_field(field, *member); !status.ok())
        return status.with_context(fmt::format("'{}'", field.name));
    }
    if (is_cdr_ && message.fields.empty()) put(uint8_t{0});
    return {};
  }

  Status put_field(const Field& field, const idf::Data& value) {
    if (field.multiplicity == Multiplicity::kOne) return put_one(field, value);
    if (size_bytes(field.kind) > 0) return put_numbers(field, value);
    const auto* list = value.get_if<idf::List>();
    if (list == nullptr) return wrong(value, "a list");
    ENGRAM_RETURN_IF_ERROR(put_length(field, list->size()));
    for (const idf::Data& element : *list) ENGRAM_RETURN_IF_ERROR(put_one(field, element));
    return {};
  }

  Status put_length(const Field& field, size_t count) {
    if (field.multiplicity == Multiplicity::kSequence) return put_count(count);
    if (count == field.count) return {};
    return invalid_argument("has {} elements, needs {}", count, field.count);
  }

  Status put_numbers(const Field& field, const idf::Data& value) {
    const auto* array = value.get_if<idf::NdArray>();
    if (array == nullptr) return wrong(value, "an ndarray");
    const idf::ElementType type = element_type(field.kind);
    if (array->type() != type)
      return invalid_argument("is an ndarray of {}, needs {}", to_string(array->type()),
                              to_string(type));
    ENGRAM_RETURN_IF_ERROR(put_length(field, static_cast<size_t>(array->count())));
    // An empty sequence is not followed by padding, as when it is decoded.
    if (array->count() > 0) align(size_bytes(field.kind));
    put_bytes(array->bytes());
    return {};
  }

  Status put_one(const Field& field, const idf::Data& value) {
    switch (field.kind) {
      case FieldKind::kBool:
        if (!value.is<bool>()) return wrong(value, "a bool");
        put(static_cast<uint8_t>(value.get<bool>()));
        return {};
      case FieldKind::kInt8:
        return put_number<int8_t>(value);
      case FieldKind::kUInt8:
        return put_number<uint8_t>(value);
      case FieldKind::kInt16:
        return put_number<int16_t>(value);
      case FieldKind::kUInt16:
        return put_number<uint16_t>(value);
      case FieldKind::kInt32:
        return put_number<int32_t>(value);
      case FieldKind::kUInt32:
        return put_number<uint32_t>(value);
      case FieldKind::kInt64:
        return put_number<int64_t>(value);
      case FieldKind::kUInt64:
        return put_number<uint64_t>(value);
      case FieldKind::kFloat32:
        return put_number<float>(value);
      case FieldKind::kFloat64:
        return put_number<double>(value);
      case FieldKind::kString:
        return put_string(value);
      case FieldKind::kTime:
        return put_time<uint32_t>(value);
      case FieldKind::kDuration:
        return put_time<int32_t>(value);
      case FieldKind::kMessage:
        break;
    }
    return put_message(definition_.message(field.message), value);
  }

  template <typename T>
  Status put_time(const idf::Data& value) {
    const idf::Data* sec = value.at("sec");
    const idf::Data* nsec = value.at("nsec");
    if (sec == nullptr || nsec == nullptr) return wrong(value, "a dict of 'sec' and 'nsec'");
    ENGRAM_RETURN_IF_ERROR(put_number<T>(*sec));
    return put_number<T>(*nsec);
  }

  Status put_string(const idf::Data& value) {
    std::span<const std::byte> text;
    if (const auto* plain = value.get_if<std::string>())
      text = as_bytes(*plain);
    else if (const auto* raw = value.get_if<idf::NdArray>();
             raw != nullptr && raw->type() == idf::ElementType::kUInt8)
      text = raw->bytes();
    else
      return wrong(value, "a string");
    // In CDR the length counts the terminating zero; in ROS 1 there is none.
    ENGRAM_RETURN_IF_ERROR(put_count(text.size() + (is_cdr_ ? 1 : 0)));
    put_bytes(text);
    if (is_cdr_) put(uint8_t{0});
    return {};
  }

  const MessageDefinition& definition_;
  bool is_cdr_;
  std::vector<std::byte> out_;
};

}  // namespace

Result<std::vector<std::byte>> encode_fields(const MessageDefinition& definition,
                                             Serialization serialization, const idf::Data& value) {
  return Encoder(definition, serialization).encode(value);
}

}  // namespace engram::datasets::ros
