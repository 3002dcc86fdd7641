// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: groups of pictures as packets of a video codec, and packets as a blob.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ltm/codec/picture.h"

namespace engram::ltm {

struct VideoPacket {
  int32_t order = 0;  ///< Position of its picture in the order of time.
  std::vector<std::byte> bytes;
};

/// A group in stored form. Source: docs/codecs.md, section "Formats".
struct VideoGroup {
  PictureLayout layout = PictureLayout::kGray8;
  uint32_t count = 0;
  uint32_t height = 0;
  uint32_t width = 0;
  std::vector<std::byte> setup;  ///< Data that the decoder needs before the first packet.
  std::vector<VideoPacket> packets;

  [[nodiscard]] std::vector<std::byte> to_bytes() const;
  /// Errors: kDataLoss.
  static Result<VideoGroup> from_bytes(std::span<const std::byte> bytes);
};

/// Encodes all arrays with an opened encoder. They must have the layout `layout`.
/// Errors: kResourceExhausted; kInvalidArgument if the encoder fails.
Result<VideoGroup> encode_group(AVCodecContext& encoder, PictureLayout layout,
                                std::span<const idf::NdArray> arrays);

/// Decodes the first `wanted` pictures of a group.
/// Errors: kDataLoss if the packets do not give them undamaged or, if all are wanted, give more.
Result<std::vector<idf::NdArray>> decode_group(AVCodecContext& decoder, const VideoGroup& group,
                                               idf::ElementType type, const idf::Shape& shape,
                                               size_t wanted);

}  // namespace engram::ltm
