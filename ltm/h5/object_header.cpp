// SPDX-License-Identifier: Apache-2.0
#include "ltm/h5/object_header.h"

#include <algorithm>

namespace engram::h5 {

namespace {

constexpr uint16_t kDataSpace = 0x01;
constexpr uint16_t kDataType = 0x03;
constexpr uint16_t kLayout = 0x08;
constexpr uint16_t kAttribute = 0x0C;
constexpr uint16_t kContinuation = 0x10;
constexpr uint16_t kAttributeInfo = 0x15;
constexpr size_t kMaxBlocks = 1024;
constexpr uint64_t kMaxBlockBytes = 1 << 26;
constexpr uint64_t kUndefined = ~uint64_t{0};

struct Block {
  uint64_t offset = 0;
  uint64_t size = 0;
};

/// The layout of the messages in an object header.
struct Form {
  bool is_old = false;
  size_t header_bytes = 0;  ///< Size of the header of one message.
};

Result<Block> first_block(const RawFile& file, uint64_t header, Form& form) {
  ENGRAM_ASSIGN_OR_RETURN(const RawBytes start, file.read(header, 16));
  form.is_old = raw_number<uint8_t>(start, 0) == 1;
  form.header_bytes = 8;
  if (form.is_old) return Block{header + 16, raw_number<uint32_t>(start, 8)};
  if (std::memcmp(start.data(), "OHDR", 4) != 0 || raw_number<uint8_t>(start, 4) != 2)
    return data_loss("offset {}: no object header", header);
  const auto flags = raw_number<uint8_t>(start, 5);
  form.header_bytes = (flags & 0x04) != 0 ? 6 : 4;
  const uint64_t size_at =
      header + 6 + ((flags & 0x20) != 0 ? 16 : 0) + ((flags & 0x10) != 0 ? 4 : 0);
  const uint64_t size_bytes = uint64_t{1} << (flags & 0x03);
  ENGRAM_ASSIGN_OR_RETURN(const RawBytes size, file.read(size_at, size_bytes));
  uint64_t value = 0;
  std::memcpy(&value, size.data(), size.size());
  return Block{size_at + size_bytes, value};
}

void add_messages(RawView rest, const Form& form, std::vector<HeaderMessage>& messages,
                  std::vector<Block>& blocks) {
  while (rest.size() >= form.header_bytes) {
    const uint16_t type =
        form.is_old ? raw_number<uint16_t>(rest, 0) : raw_number<uint8_t>(rest, 0);
    const auto size = raw_number<uint16_t>(rest, form.is_old ? 2 : 1);
    const auto flags = raw_number<uint8_t>(rest, form.is_old ? 4 : 3);
    if (size > rest.size() - form.header_bytes) return;
    const RawView body = rest.subspan(form.header_bytes, size);
    if (type == kContinuation && body.size() >= 16) {
      Block next{raw_number<uint64_t>(body, 0), raw_number<uint64_t>(body, 8)};
      // Newer continuation blocks begin with a signature and end with a checksum.
      if (!form.is_old) next = {next.offset + 4, next.size < 8 ? 0 : next.size - 8};
      blocks.push_back(next);
    }
    messages.push_back({type, (flags & 0x02) != 0, {body.begin(), body.end()}});
    rest = rest.subspan(form.header_bytes + size);
  }
}

const HeaderMessage* find(const std::vector<HeaderMessage>& header, uint16_t type) {
  const auto found = std::ranges::find(header, type, &HeaderMessage::type);
  return found == header.end() ? nullptr : &*found;
}

std::optional<std::vector<uint64_t>> shape_of(RawView space) {
  if (space.size() < 4) return std::nullopt;
  const auto version = raw_number<uint8_t>(space, 0);
  const auto rank = raw_number<uint8_t>(space, 1);
  const size_t at = version == 1 ? 8 : 4;
  if (version < 1 || version > 2 || at + rank * 8u > space.size()) return std::nullopt;
  std::vector<uint64_t> shape;
  for (size_t i = 0; i < rank; ++i) shape.push_back(raw_number<uint64_t>(space, at + i * 8));
  return shape;
}

/// Sizes of a chunk, the element size last, or nullopt if they exceed the message.
std::optional<std::vector<uint64_t>> chunk_of(RawView layout) {
  const bool is_old = raw_number<uint8_t>(layout, 0) == 3;
  const size_t header_bytes = is_old ? 11 : 5;
  if (layout.size() < header_bytes) return std::nullopt;
  const auto count = raw_number<uint8_t>(layout, is_old ? 2 : 3);
  const size_t bytes = is_old ? 4 : raw_number<uint8_t>(layout, 4);
  if (bytes < 1 || bytes > 8 || header_bytes + count * bytes > layout.size()) return std::nullopt;
  std::vector<uint64_t> chunk(count, 0);
  for (size_t i = 0; i < count; ++i)
    std::memcpy(&chunk[i], layout.data() + header_bytes + i * bytes, bytes);
  return chunk;
}

Status check_compact(RawView layout, const std::vector<uint64_t>& shape, uint64_t element_bytes) {
  uint64_t needed = element_bytes;
  for (const uint64_t size : shape)
    if (__builtin_mul_overflow(needed, size, &needed)) return data_loss("is larger than 64 bits");
  const uint64_t found = layout.size() < 4 ? 0 : raw_number<uint16_t>(layout, 2);
  if (found < needed || found > layout.size() - 4)
    return data_loss("has {} compact bytes, needs {}", found, needed);
  return {};
}

}  // namespace

Result<std::vector<HeaderMessage>> read_object_header(const RawFile& file, uint64_t offset) {
  Form form;
  ENGRAM_ASSIGN_OR_RETURN(const Block first, first_block(file, offset, form));
  std::vector<Block> blocks{first};
  std::vector<HeaderMessage> messages;
  for (size_t i = 0; i < blocks.size(); ++i) {
    // Continuations of a hostile file may form a cycle; the max number of blocks ends it.
    if (i == kMaxBlocks || blocks[i].size > kMaxBlockBytes)
      return data_loss("offset {}: the object header is too large", offset);
    ENGRAM_ASSIGN_OR_RETURN(const RawBytes block, file.read(blocks[i].offset, blocks[i].size));
    add_messages(block, form, messages, blocks);
  }
  return messages;
}

Status check_dataset(const std::vector<HeaderMessage>& header) {
  const HeaderMessage* space = find(header, kDataSpace);
  const HeaderMessage* type = find(header, kDataType);
  const HeaderMessage* layout = find(header, kLayout);
  if (space == nullptr || type == nullptr || layout == nullptr)
    return data_loss("is no dataset, or a damaged one");
  if (type->is_shared || space->is_shared) return data_loss("has a named type, which is not read");
  const auto shape = shape_of(space->body);
  if (!shape || type->body.size() < 8 || layout->body.size() < 2)
    return data_loss("has a broken shape, type or layout");
  const auto element_bytes = raw_number<uint32_t>(type->body, 4);
  const auto version = raw_number<uint8_t>(layout->body, 0);
  const auto layout_class = raw_number<uint8_t>(layout->body, 1);
  if (version < 3 || version > 4 || layout_class > 2)
    return data_loss("has layout {} of version {}, which is not read", layout_class, version);
  if (layout_class == 0) return check_compact(layout->body, *shape, element_bytes);
  if (layout_class == 1) return {};
  // HDF5 trusts that the sizes in layout, shape and type agree, and reads out of bounds if they do
  // not.
  const auto chunk = chunk_of(layout->body);
  if (!chunk || chunk->size() != shape->size() + 1 || chunk->back() != element_bytes ||
      std::ranges::find(*chunk, 0u) != chunk->end())
    return data_loss("has chunks that do not fit its shape and type");
  return {};
}

std::optional<HeaderAttribute> header_attribute(const HeaderMessage& message) {
  const RawView body = message.body;
  if (message.type != kAttribute || message.is_shared || body.size() < 8) return std::nullopt;
  const auto version = raw_number<uint8_t>(body, 0);
  if (version < 1 || version > 3) return std::nullopt;
  const auto size_of = [&](size_t at) -> uint64_t {
    const auto size = raw_number<uint16_t>(body, at);
    return version == 1 ? padded_size(size) : size;
  };
  const uint64_t name_at = version == 3 ? 9 : 8;
  const uint64_t value_at = name_at + size_of(2) + size_of(4) + size_of(6);
  if (value_at > body.size() || raw_number<uint16_t>(body, 2) == 0) return std::nullopt;
  const std::string_view name(reinterpret_cast<const char*>(body.data()) + name_at,
                              raw_number<uint16_t>(body, 2));
  if (name.back() != '\0') return std::nullopt;
  return HeaderAttribute{name.substr(0, name.find('\0')), body.subspan(value_at)};
}

bool has_broken_attributes(const std::vector<HeaderMessage>& header) {
  return std::ranges::any_of(header, [](const HeaderMessage& message) {
    return message.type == kAttribute && !message.is_shared && !header_attribute(message);
  });
}

bool has_outer_attributes(const std::vector<HeaderMessage>& header) {
  const HeaderMessage* info = find(header, kAttributeInfo);
  if (info == nullptr || info->body.size() < 10) return false;
  const size_t at = (raw_number<uint8_t>(info->body, 1) & 0x01) != 0 ? 4 : 2;
  return at + 8 <= info->body.size() && raw_number<uint64_t>(info->body, at) != kUndefined;
}

}  // namespace engram::h5
