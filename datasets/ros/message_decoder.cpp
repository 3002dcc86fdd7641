// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include "datasets/ros/message_coding.h"
#include "ltm/core/utf8.h"

namespace engram::datasets::ros {

namespace {

constexpr size_t kMaxPadding = 8;
/// The maximum number of messages without fields, which cost no bytes and so are not bounded by
/// them.
constexpr uint64_t kFreeValues = 1 << 12;

template <typename T>
T swapped(T value) {
  auto* bytes = reinterpret_cast<std::byte*>(&value);
  std::reverse(bytes, bytes + sizeof(T));
  return value;
}

class Decoder {
 public:
  Decoder(const MessageDefinition& definition, Serialization serialization,
          std::span<const std::byte> bytes)
      : definition_(definition), bytes_(bytes), is_cdr_(serialization == Serialization::kCdr) {}

  Result<idf::Data> decode() {
    if (is_cdr_) ENGRAM_RETURN_IF_ERROR(begin_cdr());
    idf::Dict value;
    ENGRAM_RETURN_IF_ERROR(take_message(definition_.root(), value));
    // Some writers of CDR pad messages to their alignment.
    if (left() > (is_cdr_ ? kMaxPadding : 0))
      return data_loss("offset {}: {} bytes follow the last field", at_, left());
    return idf::Data(std::move(value));
  }

 private:
  [[nodiscard]] size_t left() const { return bytes_.size() - at_; }

  Status begin_cdr() {
    if (left() < kEncapsulationBytes)
      return data_loss("message of {} bytes: needs {} of encapsulation", left(),
                       kEncapsulationBytes);
    const auto high = std::to_integer<int>(bytes_[0]);
    const auto low = std::to_integer<int>(bytes_[1]);
    if (high != 0 || low > 1)
      return data_loss("encapsulation is 0x{:02x}{:02x}, needs 0 (big-endian CDR) or 1 (little)",
                       high, low);
    is_big_endian_ = low == 0;
    at_ = kEncapsulationBytes;
    return {};
  }

  Status needs(uint64_t bytes, std::string_view what) const {
    if (bytes <= left()) return {};
    return data_loss("offset {}: '{}' needs {} bytes, {} are left", at_, what, bytes, left());
  }

  /// Bounds the number of values that need no bytes.
  Status count_free(size_t before) {
    if (at_ != before || free_values_left_-- > 0) return {};
    return data_loss("offset {}: more than {} values without bytes", at_, kFreeValues);
  }

  Status align(size_t size, std::string_view what) {
    if (!is_cdr_ || size < 2) return {};
    const size_t over = (at_ - kEncapsulationBytes) % size;
    if (over == 0) return {};
    ENGRAM_RETURN_IF_ERROR(needs(size - over, what));
    at_ += size - over;
    return {};
  }

  template <typename T>
  Result<T> take(std::string_view what) {
    ENGRAM_RETURN_IF_ERROR(align(sizeof(T), what));
    ENGRAM_RETURN_IF_ERROR(needs(sizeof(T), what));
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return is_big_endian_ ? swapped(value) : value;
  }

  template <typename T, typename As = T>
  Result<idf::Data> take_number(std::string_view what) {
    ENGRAM_ASSIGN_OR_RETURN(const T value, take<T>(what));
    return idf::Data(static_cast<As>(value));
  }

  Status take_message(const Message& message, idf::Dict& value) {
    value.reserve(message.fields.size());
    for (const Field& field : message.fields) {
      const size_t before = at_;
      ENGRAM_ASSIGN_OR_RETURN(idf::Data member, take_field(field));
      ENGRAM_RETURN_IF_ERROR(count_free(before));
      value.append_unique(field.name, std::move(member));
    }
    // An empty structure has one byte in CDR.
    if (!is_cdr_ || !message.fields.empty()) return {};
    const auto filler = take<uint8_t>(message.name);
    return filler.status();
  }

  Result<idf::Data> take_field(const Field& field) {
    if (field.multiplicity == Multiplicity::kOne) return take_one(field);
    uint64_t count = field.count;
    if (field.multiplicity == Multiplicity::kSequence) {
      ENGRAM_ASSIGN_OR_RETURN(count, take<uint32_t>(field.name));
    }
    if (size_bytes(field.kind) > 0) return take_numbers(field, count);
    idf::List list;
    for (uint64_t i = 0; i < count; ++i) {
      const size_t before = at_;
      ENGRAM_ASSIGN_OR_RETURN(idf::Data element, take_one(field));
      ENGRAM_RETURN_IF_ERROR(count_free(before));
      list.push_back(std::move(element));
    }
    return idf::Data(std::move(list));
  }

  Result<idf::Data> take_numbers(const Field& field, uint64_t count) {
    const size_t size = size_bytes(field.kind);
    // An empty sequence is not followed by padding.
    if (count > 0) ENGRAM_RETURN_IF_ERROR(align(size, field.name));
    ENGRAM_RETURN_IF_ERROR(needs(count * size, field.name));
    std::vector<std::byte> plain(bytes_.begin() + at_, bytes_.begin() + at_ + count * size);
    at_ += plain.size();
    if (is_big_endian_)
      for (size_t i = 0; i < plain.size(); i += size)
        std::reverse(plain.begin() + i, plain.begin() + i + size);
    auto array = idf::NdArray::create(element_type(field.kind), {static_cast<int64_t>(count)},
                                      Buffer::take(std::move(plain)));
    if (!array.ok()) return array.status();
    return idf::Data(*std::move(array));
  }

  Result<idf::Data> take_one(const Field& field) {
    switch (field.kind) {
      case FieldKind::kBool: {
        ENGRAM_ASSIGN_OR_RETURN(const uint8_t value, take<uint8_t>(field.name));
        return idf::Data(value != 0);
      }
      case FieldKind::kInt8:
        return take_number<int8_t, int32_t>(field.name);
      case FieldKind::kUInt8:
        return take_number<uint8_t, int32_t>(field.name);
      case FieldKind::kInt16:
        return take_number<int16_t, int32_t>(field.name);
      case FieldKind::kUInt16:
        return take_number<uint16_t, int32_t>(field.name);
      case FieldKind::kInt32:
        return take_number<int32_t>(field.name);
      case FieldKind::kUInt32:
        return take_number<uint32_t, int64_t>(field.name);
      case FieldKind::kInt64:
        return take_number<int64_t>(field.name);
      case FieldKind::kUInt64: {
        ENGRAM_ASSIGN_OR_RETURN(const uint64_t value, take<uint64_t>(field.name));
        return idf::Data(idf::NdArray::take<uint64_t>({}, {value}));
      }
      case FieldKind::kFloat32:
        return take_number<float>(field.name);
      case FieldKind::kFloat64:
        return take_number<double>(field.name);
      case FieldKind::kString:
        return take_string(field.name);
      case FieldKind::kTime:
        return take_time<uint32_t, int64_t>(field.name);
      case FieldKind::kDuration:
        return take_time<int32_t, int32_t>(field.name);
      case FieldKind::kMessage:
        break;
    }
    idf::Dict value;
    ENGRAM_RETURN_IF_ERROR(take_message(definition_.message(field.message), value));
    return idf::Data(std::move(value));
  }

  template <typename T, typename As>
  Result<idf::Data> take_time(std::string_view what) {
    ENGRAM_ASSIGN_OR_RETURN(const T sec, take<T>(what));
    ENGRAM_ASSIGN_OR_RETURN(const T nsec, take<T>(what));
    return idf::Data(idf::Dict{{"sec", static_cast<As>(sec)}, {"nsec", static_cast<As>(nsec)}});
  }

  Result<idf::Data> take_string(std::string_view what) {
    ENGRAM_ASSIGN_OR_RETURN(uint32_t length, take<uint32_t>(what));
    ENGRAM_RETURN_IF_ERROR(needs(length, what));
    auto text = as_text(bytes_.subspan(at_, length));
    at_ += length;
    if (is_cdr_ && text.ends_with('\0')) text.remove_suffix(1);
    if (is_utf8(text)) return idf::Data(text);
    return idf::Data(idf::NdArray::take<uint8_t>({static_cast<int64_t>(text.size())},
                                                 {text.begin(), text.end()}));
  }

  const MessageDefinition& definition_;
  std::span<const std::byte> bytes_;
  bool is_cdr_;
  bool is_big_endian_ = false;
  size_t at_ = 0;
  uint64_t free_values_left_ = kFreeValues;
};

}  // namespace

idf::ElementType element_type(FieldKind kind) {
  switch (kind) {
    case FieldKind::kInt8:
      return idf::ElementType::kInt8;
    case FieldKind::kInt16:
      return idf::ElementType::kInt16;
    case FieldKind::kUInt16:
      return idf::ElementType::kUInt16;
    case FieldKind::kInt32:
      return idf::ElementType::kInt32;
    case FieldKind::kUInt32:
      return idf::ElementType::kUInt32;
    case FieldKind::kInt64:
      return idf::ElementType::kInt64;
    case FieldKind::kUInt64:
      return idf::ElementType::kUInt64;
    case FieldKind::kFloat32:
      return idf::ElementType::kFloat32;
    case FieldKind::kFloat64:
      return idf::ElementType::kFloat64;
    default:
      return idf::ElementType::kUInt8;
  }
}

Result<idf::Data> decode_fields(const MessageDefinition& definition, Serialization serialization,
                                std::span<const std::byte> bytes) {
  return Decoder(definition, serialization, bytes).decode();
}

}  // namespace engram::datasets::ros
