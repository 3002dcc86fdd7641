// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/av1_packets.h"

#include <utility>

#include "ltm/codec/video_stream.h"
#include "ltm/core/check.h"

namespace engram::ltm {

Result<Av1Packets> av1_packets(std::span<const std::byte> group) {
  ENGRAM_ASSIGN_OR_RETURN(VideoGroup video, VideoGroup::from_bytes(group));
  if (video.packets.size() != video.count)
    return data_loss("av1: found {} packets for {} pictures", video.packets.size(), video.count);
  Av1Packets found{.is_deep = video.layout != shallow(video.layout), .packets = {}};
  for (VideoPacket& packet : video.packets) {
    if (packet.order != static_cast<int32_t>(found.packets.size()))
      return data_loss("av1: found packet {} at place {}", packet.order, found.packets.size());
    found.packets.push_back(std::move(packet.bytes));
  }
  return found;
}

std::vector<std::byte> av1_group(Av1Packets packets, const idf::Shape& shape) {
  const auto layout = layout_of(idf::ElementType::kUInt8, shape, false);
  ENGRAM_CHECK(layout.has_value(), "a picture of shape {}", idf::to_string(shape));
  // Each key frame repeats the setup, so a decoder does not need it.
  VideoGroup group{.layout = packets.is_deep ? deep(*layout) : *layout,
                   .count = static_cast<uint32_t>(packets.packets.size()),
                   .height = static_cast<uint32_t>(shape[0]),
                   .width = static_cast<uint32_t>(shape[1])};
  for (std::vector<std::byte>& packet : packets.packets)
    group.packets.push_back({static_cast<int32_t>(group.packets.size()), std::move(packet)});
  return group.to_bytes();
}

}  // namespace engram::ltm
