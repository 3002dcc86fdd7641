// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/medium_decoder.h"

#include <algorithm>

#include "ltm/codec/codec.h"
#include "ltm/codec/group_codec.h"

namespace engram::ltm {

namespace {

Result<idf::NdArray> decode_single(const PackedMedium& medium) {
  const Codec* codec = find_codec(medium.codec);
  if (codec == nullptr) return data_loss("unknown codec '{}'", medium.codec);
  return codec->decode(medium.bytes.bytes(), medium.type, medium.shape);
}

/// Plain bytes of the group that a medium belongs to.
/// Errors: kDataLoss if they exceed the max of a group, or if the medium's place is not in the
/// group.
Result<uint64_t> group_bytes(const PackedMedium& medium) {
  const auto bytes = idf::size_bytes(medium.type, medium.shape);
  const GroupPlace& place = *medium.group;
  if (place.index >= place.count)
    return data_loss("is image {} of a group of {}", place.index, place.count);
  if (!bytes || *bytes > kMaxGroupBytes || *bytes * place.count > kMaxGroupBytes)
    return data_loss("is of a group of {} {} {}, at most {} bytes fit", place.count,
                     to_string(medium.type), idf::to_string(medium.shape), kMaxGroupBytes);
  return *bytes * place.count;
}

}  // namespace

Result<idf::NdArray> MediumDecoder::decode(const PackedMedium& medium) {
  if (!medium.group) return decode_single(medium);
  ENGRAM_ASSIGN_OR_RETURN(const Group* group, group_of(medium));
  return group->arrays[medium.group->index];
}

Result<const MediumDecoder::Group*> MediumDecoder::group_of(const PackedMedium& medium) {
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size_bytes, group_bytes(medium));
  const auto is_same = [&](const Group& group) {
    return group.bytes.data() == medium.bytes.data() && group.bytes.size() == medium.bytes.size() &&
           group.arrays.size() == medium.group->count && group.arrays[0].type() == medium.type &&
           group.arrays[0].shape() == medium.shape;
  };
  auto known = std::ranges::find_if(groups_, is_same);
  if (known == groups_.end()) {
    const GroupCodec* codec = find_group_codec(medium.codec);
    if (codec == nullptr) return data_loss("unknown group codec '{}'", medium.codec);
    make_room(size_bytes);
    ENGRAM_ASSIGN_OR_RETURN(auto arrays, codec->decode(medium.bytes.bytes(), medium.type,
                                                       medium.shape, medium.group->count));
    known = groups_.insert(groups_.end(), {medium.bytes, std::move(arrays), size_bytes, 0});
  }
  known->last_use = ++uses_;
  return &*known;
}

void MediumDecoder::make_room(uint64_t bytes) {
  for (const Group& group : groups_) bytes += group.size_bytes;
  while (!groups_.empty() && bytes > kKeptBytes) {
    const auto oldest = std::ranges::min_element(groups_, {}, &Group::last_use);
    bytes -= oldest->size_bytes;
    groups_.erase(oldest);
  }
}

}  // namespace engram::ltm
