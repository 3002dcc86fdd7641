// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: owners for the C types of FFmpeg's libraries, and explicit colour formats.

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

/// The layout of the pixels of a picture, and the meaning of their numbers.
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

/// The format that a decoded frame states. If it states no matrix, it is BT.709 from 720 lines
/// upwards and BT.601 below, as in common players; if it states no range, it is the limited one.
[[nodiscard]] PixelFormat format_of(const AVFrame& frame);

/// Returns true if every plane of `from`, including chroma, is at least as large as in `to`.
[[nodiscard]] bool shrinks_all_planes(const PixelFormat& from, const PixelFormat& to);

/// Makes a converter between two formats of one size or, if all planes shrink, one that averages
/// areas. Matrices and ranges are set explicitly, and chroma is interpolated with accurate
/// rounding: the defaults cost up to 5 dB.
/// Errors: kInvalidArgument if a format or matrix is not supported.
Result<Scaler> make_converter(const PixelFormat& from, const PixelFormat& to);

}  // namespace engram::datasets::libav
