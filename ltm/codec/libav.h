// SPDX-License-Identifier: Apache-2.0
#pragma once

// Not installed; for this room and datasets: owners for the C types of FFmpeg's libavcodec.

extern "C" {
#include <libavcodec/avcodec.h>
}

#include <memory>
#include <string>

namespace engram::ltm::libav {

struct Deleter {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};

template <typename T>
using Owned = std::unique_ptr<T, Deleter>;

/// The library's description of an error.
[[nodiscard]] std::string describe(int error);

/// Stops the library from printing; its errors are reported as Status instead.
void keep_quiet();

}  // namespace engram::ltm::libav
