// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: group codecs through libavcodec.

#include "ltm/codec/codec.h"
#include "ltm/codec/codec_text.h"
#include "ltm/codec/group_codec.h"

namespace engram::ltm {

/// The properties of one video codec.
struct VideoKind {
  std::string_view name;
  const char* encoder;
  const char* decoder;
  bool is_lossless;
  /// Encoders refuse smaller pictures, and that of FFV1 writes wrong ones. Unit: pixels.
  int64_t min_side;
  int crf;  ///< Default quality; lower is better.
  int max_crf;
  int effort;      ///< Default effort.
  int max_effort;  ///< 0 is the fastest.
  int group;       ///< Default size of a group.
};

/// The supported kinds: ffv1, h264, h265, av1.
[[nodiscard]] std::span<const VideoKind> video_kinds();

[[nodiscard]] bool is_installed(const VideoKind& kind);

/// Errors: kInvalidArgument if an option is out of range.
Result<std::unique_ptr<const GroupCodec>> make_video_codec(const VideoKind& kind, CodecText text);

/// Makes "ffv1" for single images: uint8 [H, W, 3] (RGB) or [H, W, 1], uint16 [H, W, 1]. Lossless.
/// Errors: kInvalidArgument for options.
Result<std::unique_ptr<const Codec>> make_ffv1_image_codec(CodecText text);

}  // namespace engram::ltm
