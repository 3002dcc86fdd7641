// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/media_sorter.h"

#include <algorithm>

#include "ltm/codec/codec.h"
#include "ltm/core/log.h"

namespace engram::ltm {

namespace {

/// Max number of streams per path that become groups; the images of further streams are stored
/// singly. Reading a row looks at every group of a path, so many streams would make reads slow.
constexpr size_t kMaxStreams = 16;

bool is_same_group(const PackedMedium& a, const PackedMedium& b) {
  return b.group && a.bytes.data() == b.bytes.data() && a.bytes.size() == b.bytes.size() &&
         a.codec == b.codec && a.group->count == b.group->count;
}

GroupColumn& column_of(std::vector<GroupColumn>& groups, const PackedMedium& like,
                       std::string_view codec) {
  const auto known = std::ranges::find(groups, codec, &GroupColumn::codec);
  if (known != groups.end()) return *known;
  return groups.emplace_back(like.path, std::string(codec), like.type, like.shape);
}

template <typename Places>
std::vector<uint64_t> rows_of(const Places& places) {
  std::vector<uint64_t> rows;
  for (const auto& place : places) rows.push_back(place.row);
  return rows;
}

}  // namespace

void MediaSorter::append(size_t row, const SegmentRow& media) {
  for (const PackedMedium& medium : media.packed().value.media)
    streams_[{medium.path, medium.type, medium.shape, media.instance}].push_back({row, &medium});
}

Result<SortedMedia> MediaSorter::finish() {
  for (const auto& [stream, places] : streams_) ENGRAM_RETURN_IF_ERROR(sort(places));
  std::ranges::stable_sort(sorted_.single, {}, &RowMedium::row);
  return std::move(sorted_);
}

Status MediaSorter::sort(Places places) {
  Groups groups;
  while (!places.empty()) {
    const PackedMedium& first = *places[0].medium;
    Places done = places.first(1);
    if (first.group) {
      done = next_group(places);
      ENGRAM_RETURN_IF_ERROR(sort_group(done, groups));
    } else if (const GroupCodec* codec = codec_for(first)) {
      done = next_run(places, *codec);
      encode(done, *codec, groups);
    } else {
      keep_single(done);
    }
    places = places.subspan(done.size());
  }
  std::ranges::move(groups, std::back_inserter(sorted_.groups));
  return {};
}

/// The codec for a group of this medium, or null if the medium stays as it is.
const GroupCodec* MediaSorter::codec_for(const PackedMedium& medium) const {
  const Codec* recorded = find_codec(medium.codec);
  if (medium.group || recorded == nullptr || !recorded->is_lossless()) return nullptr;
  return rules_.group_codec(medium.path, medium.type, medium.shape);
}

/// The leading images that are in one group and follow each other in it.
MediaSorter::Places MediaSorter::next_group(Places places) const {
  const PackedMedium& first = *places[0].medium;
  size_t count = 1;
  while (count < places.size() && is_same_group(first, *places[count].medium) &&
         places[count].medium->group->index == first.group->index + count)
    ++count;
  return places.first(count);
}

/// The leading images that fit into one group.
MediaSorter::Places MediaSorter::next_run(Places places, const GroupCodec& codec) const {
  const uint64_t bytes = *idf::size_bytes(places[0].medium->type, places[0].medium->shape);
  const size_t max =
      std::clamp<uint64_t>(kMaxGroupBytes / std::max<uint64_t>(bytes, 1), 1, codec.group_size());
  size_t count = 1;
  while (count < std::min(max, places.size()) && codec_for(*places[count].medium) == &codec)
    ++count;
  return places.first(count);
}

Status MediaSorter::sort_group(Places group, Groups& groups) {
  const PackedMedium& first = *group[0].medium;
  if (group.size() == first.group->count) {
    column_of(groups, first, first.codec).append(first.bytes.bytes(), rows_of(group));
    return {};
  }
  for (const Place& place : group) {
    ENGRAM_ASSIGN_OR_RETURN(PackedMedium alone, pack_alone(*place.medium, decoder_));
    sorted_.single.push_back({place.row, std::move(alone)});
  }
  return {};
}

void MediaSorter::encode(Places run, const GroupCodec& codec, Groups& groups) {
  const PackedMedium& first = *run[0].medium;
  const bool is_new = std::ranges::find(groups, codec.name(), &GroupColumn::codec) == groups.end();
  if (is_new && encoded_streams_[first.path] >= kMaxStreams) return keep_single(run);
  const auto bytes = encode(run, codec);
  if (!bytes.ok()) {
    log::warning("{} images '{}' are sealed as they were recorded: {}", run.size(), first.path,
                 bytes.status().to_string());
    return keep_single(run);
  }
  if (is_new) ++encoded_streams_[first.path];
  column_of(groups, first, codec.name()).append(*bytes, rows_of(run));
}

Result<std::vector<std::byte>> MediaSorter::encode(Places run, const GroupCodec& codec) {
  std::vector<idf::NdArray> images;
  for (const Place& place : run) {
    ENGRAM_ASSIGN_OR_RETURN(idf::NdArray image, decoder_.decode(*place.medium));
    images.push_back(std::move(image));
  }
  return codec.encode(images);
}

void MediaSorter::keep_single(Places places) {
  for (const Place& place : places) sorted_.single.push_back({place.row, *place.medium});
}

}  // namespace engram::ltm
