// SPDX-License-Identifier: Apache-2.0
#include "encoders/video_reference.h"

#include <xxhash.h>

#include <cmath>

#include "encoders/coding/byte_stream.h"
#include "encoders/coding/checked_block.h"

namespace engram::encoders {

namespace {

constexpr std::string_view kReferences = "references of videos";
constexpr int64_t kMaxKey = 63;

/// What precedes the bytes of a reference.
struct ReferenceHead {
  VideoReference reference;
  int64_t depth = 0, picture_bytes = 0, key_frame_bytes = 0;
};

ReferenceHead read_reference_head(ByteReader& reader) {
  ReferenceHead head;
  head.reference.time = reader.get<int64_t>();
  head.reference.reach = reader.get<float>();
  const int64_t key = reader.get_varint();
  head.reference.key = key >= 0 && key <= kMaxKey ? static_cast<int32_t>(key) : -1;
  head.depth = reader.get_varint();
  head.reference.is_deep = head.depth == 10;
  head.picture_bytes = reader.get_varint();
  head.key_frame_bytes = reader.get_varint();
  return head;
}

}  // namespace

uint64_t VideoReference::hash() const {
  return XXH3_64bits(key_frame.data(), key_frame.size());
}

std::vector<std::byte> to_bytes(std::span<const VideoReference> references) {
  ByteWriter writer;
  writer.put_varint(static_cast<int64_t>(references.size()));
  for (const VideoReference& reference : references) {
    writer.put(reference.time);
    writer.put(reference.reach);
    writer.put_varint(reference.key);
    writer.put_varint(reference.is_deep ? 10 : 8);
    writer.put_varint(static_cast<int64_t>(reference.picture.size()));
    writer.put_varint(static_cast<int64_t>(reference.key_frame.size()));
    for (const auto& bytes : {reference.picture, reference.key_frame})
      for (const std::byte byte : bytes) writer.put(std::to_integer<uint8_t>(byte));
  }
  return writer.take();
}

Result<std::vector<VideoReference>> references_from(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  const int64_t count = reader.get_varint();
  if (reader.failed() || count < 0 || static_cast<uint64_t>(count) > kMaxReferences)
    return data_loss("{}: found {}, needs at most {}", kReferences, count, kMaxReferences);
  std::vector<VideoReference> references;
  std::span<const std::byte> rest = reader.rest();
  for (int64_t i = 0; i < count; ++i) {
    ByteReader heads(rest);
    ReferenceHead head = read_reference_head(heads);
    if (heads.failed()) return data_loss("{}: end within a head", kReferences);
    if (head.reference.key < 0 || (head.depth != 8 && head.depth != 10) ||
        !std::isfinite(head.reference.reach))
      return data_loss("{}: found one of key {}, depth {}, reach {}", kReferences,
                       head.reference.key, head.depth, head.reference.reach);
    rest = heads.rest();
    ENGRAM_ASSIGN_OR_RETURN(const auto picture, take_part(rest, head.picture_bytes, kReferences));
    ENGRAM_ASSIGN_OR_RETURN(const auto key, take_part(rest, head.key_frame_bytes, kReferences));
    head.reference.picture.assign(picture.begin(), picture.end());
    head.reference.key_frame.assign(key.begin(), key.end());
    references.push_back(std::move(head.reference));
  }
  if (!rest.empty()) return data_loss("{}: found {} bytes behind them", kReferences, rest.size());
  return references;
}

}  // namespace engram::encoders
