// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the C types of FFmpeg's libraries with owners and colours spelled out.

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <memory>

#include "ltm/codec/libav.h"
#include "ltm/core/status.h"

namespace engram::datasets::libav {

using ltm::libav::describe;
using ltm::libav::keep_quiet;

struct InputCloser {
  void operator()(AVFormatContext* input) const { avformat_close_input(&input); }
};
struct ScalerFreer {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};

using Input = std::unique_ptr<AVFormatContext, InputCloser>;
using Codec = ltm::libav::Owned<AVCodecContext>;
using Frame = ltm::libav::Owned<AVFrame>;
using Packet = ltm::libav::Owned<AVPacket>;
using Scaler = std::unique_ptr<SwsContext, ScalerFreer>;

/// How the pixels of a picture are laid out and what their numbers mean.
struct PixelFormat {
  int width = 0;
  int height = 0;
  AVPixelFormat format = AV_PIX_FMT_NONE;
  AVColorSpace matrix = AVCOL_SPC_UNSPECIFIED;
  bool is_full_range = false;
  AVChromaLocation chroma = AVCHROMA_LOC_UNSPECIFIED;

  friend bool operator==(const PixelFormat&, const PixelFormat&) = default;
};

/// RGB, 8 bits each, packed.
[[nodiscard]] PixelFormat rgb_format(int width, int height);

/// What a decoded frame states. Where it states no matrix, players agree on BT.709 from 720 lines
/// on and on BT.601 below; where it states no range, on the limited one.
[[nodiscard]] PixelFormat format_of(const AVFrame& frame);

/// Whether every plane of `from`, chroma too, has at least the size of `to`.
[[nodiscard]] bool shrinks_all_planes(const PixelFormat& from, const PixelFormat& to);

/// Converts between two formats of one size, or, where all planes shrink, averages areas on the
/// way. Both matrices and ranges are set explicitly and all chroma is interpolated with accurate
/// rounding: the defaults cost up to 5 dB.
/// Errors: kInvalidArgument where a format or matrix is not supported.
Result<Scaler> make_converter(const PixelFormat& from, const PixelFormat& to);

}  // namespace engram::datasets::libav
