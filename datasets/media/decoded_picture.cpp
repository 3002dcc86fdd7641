// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/decoded_picture.h"

#include <cstring>

extern "C" {
#include <libavutil/imgutils.h>
}

#include "datasets/media/video_reader.h"

namespace engram::datasets {

namespace {

AVPixelFormat format_of(const AVFrame& frame) {
  return static_cast<AVPixelFormat>(frame.format);
}

/// The number of rows of a plane; chroma planes may have fewer.
int rows_of(const AVFrame& frame, int plane) {
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(format_of(frame));
  const bool is_chroma = plane == 1 || plane == 2;
  return is_chroma ? -((-frame.height) >> format->log2_chroma_h) : frame.height;
}

bool is_same_plane(const AVFrame& a, const AVFrame& b, int plane) {
  const int bytes = av_image_get_linesize(format_of(a), a.width, plane);
  if (bytes < 0) return false;
  for (int row = 0; row < rows_of(a, plane); ++row)
    if (std::memcmp(a.data[plane] + static_cast<std::ptrdiff_t>(row) * a.linesize[plane],
                    b.data[plane] + static_cast<std::ptrdiff_t>(row) * b.linesize[plane],
                    static_cast<size_t>(bytes)) != 0)
      return false;
  return true;
}

}  // namespace

size_t DecodedPicture::bytes() const {
  size_t total = 0;
  for (const AVBufferRef* buffer : frame_->buf)
    if (buffer != nullptr) total += buffer->size;
  return total;
}

bool operator==(const DecodedPicture& a, const DecodedPicture& b) {
  const AVFrame& left = a.frame();
  const AVFrame& right = b.frame();
  if (left.format != right.format || left.width != right.width || left.height != right.height)
    return false;
  for (int plane = 0; plane < av_pix_fmt_count_planes(format_of(left)); ++plane)
    if (!is_same_plane(left, right, plane)) return false;
  const bool has_palette = (av_pix_fmt_desc_get(format_of(left))->flags & AV_PIX_FMT_FLAG_PAL) != 0;
  return !has_palette || std::memcmp(left.data[1], right.data[1], AVPALETTE_SIZE) == 0;
}

size_t DecodedFrame::bytes() const {
  return picture->bytes();
}

bool DecodedFrame::repeats(const DecodedFrame& other) const {
  return *picture == *other.picture;
}

}  // namespace engram::datasets
