// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/packed_value.h"

#include "ltm/codec/codec.h"
#include "ltm/codec/zstd_codec.h"
#include "ltm/idf/layout.h"

namespace engram::ltm {

Result<PackedValue> pack(const idf::Data& value, const PackOptions& options) {
  const Codec* image_codec = find_codec(options.image_codec);
  if (image_codec == nullptr) return invalid_argument("unknown codec '{}'", options.image_codec);
  PackedValue packed{value, {}};
  const idf::Layout layout = idf::Layout::of(value);
  for (const idf::TensorMember& member : layout.members()) {
    if (member.kind != idf::MemberKind::kImage) continue;
    const Codec& codec =
        image_codec->accepts(member.type, member.shape) ? *image_codec : zstd_codec();
    const auto& array = value.at(member.path)->get<idf::NdArray>();
    auto bytes = codec.encode(array);
    if (!bytes.ok()) return bytes.status().with_context("member '" + member.path + "'");
    packed.media.push_back({member.path, std::string(codec.name()), member.type, member.shape,
                            Buffer::take(std::move(bytes).value())});
    *packed.rest.at(member.path) = idf::None{};
  }
  return packed;
}

Result<idf::Data> unpack(const PackedValue& packed) {
  idf::Data value = packed.rest;
  for (const PackedMedium& medium : packed.media) {
    idf::Data* place = value.at(medium.path);
    if (place == nullptr || !place->is<idf::None>())
      return data_loss("member '{}': the value has no place for it", medium.path);
    const Codec* codec = find_codec(medium.codec);
    if (codec == nullptr)
      return data_loss("member '{}': unknown codec '{}'", medium.path, medium.codec);
    auto array = codec->decode(medium.bytes.bytes(), medium.type, medium.shape);
    if (!array.ok()) return array.status().with_context("member '" + medium.path + "'");
    *place = std::move(array).value();
  }
  return value;
}

}  // namespace engram::ltm
