// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/av1_packets.h"

#include <utility>

#include "ltm/codec/video_stream.h"
#include "ltm/core/check.h"

namespace engram::ltm {

Result<std::vector<std::vector<std::byte>>> av1_packets(std::span<const std::byte> group) {
  ENGRAM_ASSIGN_OR_RETURN(VideoGroup video, VideoGroup::from_bytes(group));
  if (video.packets.size() != video.count)
    return data_loss("av1: found {} packets for {} pictures", video.packets.size(), video.count);
  std::vector<std::vector<std::byte>> packets;
  for (VideoPacket& packet : video.packets) {
    if (packet.order != static_cast<int32_t>(packets.size()))
      return data_loss("av1: found packet {} at place {}", packet.order, packets.size());
    packets.push_back(std::move(packet.bytes));
  }
  return packets;
}

std::vector<std::byte> av1_group(std::vector<std::vector<std::byte>> packets,
                                 const idf::Shape& shape) {
  const auto layout = layout_of(idf::ElementType::kUInt8, shape, false);
  ENGRAM_CHECK(layout.has_value(), "a picture of shape {}", idf::to_string(shape));
  // Each key frame repeats the setup, so a decoder does not need it.
  VideoGroup group{.layout = deep(*layout),
                   .count = static_cast<uint32_t>(packets.size()),
                   .height = static_cast<uint32_t>(shape[0]),
                   .width = static_cast<uint32_t>(shape[1])};
  for (std::vector<std::byte>& packet : packets)
    group.packets.push_back({static_cast<int32_t>(group.packets.size()), std::move(packet)});
  return group.to_bytes();
}

}  // namespace engram::ltm
