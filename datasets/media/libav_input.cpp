// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/libav_input.h"

#include <string_view>

extern "C" {
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
}

namespace engram::datasets::libav {

namespace {

constexpr int kSmallHeight = 720;
constexpr int kFlags = SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP;

/// The old "J" formats only say that the range is full; swscale needs the plain ones.
AVPixelFormat plain(AVPixelFormat format) {
  switch (format) {
    case AV_PIX_FMT_YUVJ420P:
      return AV_PIX_FMT_YUV420P;
    case AV_PIX_FMT_YUVJ411P:
      return AV_PIX_FMT_YUV411P;
    case AV_PIX_FMT_YUVJ422P:
      return AV_PIX_FMT_YUV422P;
    case AV_PIX_FMT_YUVJ440P:
      return AV_PIX_FMT_YUV440P;
    case AV_PIX_FMT_YUVJ444P:
      return AV_PIX_FMT_YUV444P;
    default:
      return format;
  }
}

bool is_rgb(AVPixelFormat format) {
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(format);
  return description != nullptr && (description->flags & AV_PIX_FMT_FLAG_RGB) != 0;
}

std::string_view name_of(AVPixelFormat format) {
  const char* name = av_get_pix_fmt_name(format);
  return name == nullptr ? "unknown" : name;
}

bool has_known_matrix(const PixelFormat& picture) {
  if (is_rgb(picture.format)) return true;
  switch (picture.matrix) {
    case AVCOL_SPC_BT709:
    case AVCOL_SPC_FCC:
    case AVCOL_SPC_BT470BG:
    case AVCOL_SPC_SMPTE170M:
    case AVCOL_SPC_SMPTE240M:
    case AVCOL_SPC_BT2020_NCL:
      return true;
    default:
      return false;
  }
}

// swscale numbers its matrices like AVColorSpace.
const int* coefficients(const PixelFormat& picture) {
  return sws_getCoefficients(is_rgb(picture.format) ? SWS_CS_DEFAULT
                                                    : static_cast<int>(picture.matrix));
}

/// Sets the position of the chroma samples, in 1/256 of a luma sample from the first one. MPEG-2,
/// H.264 and AV1 put them on the left column unless they say otherwise; JPEG and MPEG-1 put them
/// into the middle.
void set_chroma(SwsContext* scaler, const char* horizontal, const char* vertical,
                AVChromaLocation location) {
  const bool is_left = location != AVCHROMA_LOC_CENTER && location != AVCHROMA_LOC_TOP;
  const bool is_top = location == AVCHROMA_LOC_TOPLEFT || location == AVCHROMA_LOC_TOP;
  av_opt_set_int(scaler, horizontal, is_left ? 0 : 128, 0);
  av_opt_set_int(scaler, vertical, is_top ? 0 : 128, 0);
}

bool has_small_chroma(AVPixelFormat format) {
  int log2_width = 0, log2_height = 0;
  return av_pix_fmt_get_chroma_sub_sample(format, &log2_width, &log2_height) == 0 &&
         log2_width == 1 && log2_height == 1;
}

void set_formats(SwsContext* scaler, const PixelFormat& from, const PixelFormat& to) {
  av_opt_set_int(scaler, "srcw", from.width, 0);
  av_opt_set_int(scaler, "srch", from.height, 0);
  av_opt_set_int(scaler, "src_format", from.format, 0);
  av_opt_set_int(scaler, "dstw", to.width, 0);
  av_opt_set_int(scaler, "dsth", to.height, 0);
  av_opt_set_int(scaler, "dst_format", to.format, 0);
  const bool is_same_size = from.width == to.width && from.height == to.height;
  av_opt_set_int(scaler, "sws_flags", kFlags | (is_same_size ? SWS_BICUBIC : SWS_AREA), 0);
  if (has_small_chroma(from.format))
    set_chroma(scaler, "src_h_chr_pos", "src_v_chr_pos", from.chroma);
  if (has_small_chroma(to.format)) set_chroma(scaler, "dst_h_chr_pos", "dst_v_chr_pos", to.chroma);
}

}  // namespace

bool shrinks_all_planes(const PixelFormat& from, const PixelFormat& to) {
  int log2_width = 0, log2_height = 0;
  if (av_pix_fmt_get_chroma_sub_sample(from.format, &log2_width, &log2_height) < 0) return false;
  return to.width <= from.width >> log2_width && to.height <= from.height >> log2_height;
}

PixelFormat rgb_format(int width, int height) {
  return {.width = width,
          .height = height,
          .format = AV_PIX_FMT_RGB24,
          .matrix = AVCOL_SPC_RGB,
          .is_full_range = true};
}

PixelFormat format_of(const AVFrame& frame) {
  const auto format = static_cast<AVPixelFormat>(frame.format);
  PixelFormat picture{.width = frame.width,
                      .height = frame.height,
                      .format = plain(format),
                      .matrix = frame.colorspace,
                      .chroma = frame.chroma_location};
  picture.is_full_range =
      frame.color_range == AVCOL_RANGE_JPEG || picture.format != format || is_rgb(format);
  if (picture.matrix == AVCOL_SPC_UNSPECIFIED || picture.matrix == AVCOL_SPC_RESERVED)
    picture.matrix = frame.height < kSmallHeight ? AVCOL_SPC_SMPTE170M : AVCOL_SPC_BT709;
  return picture;
}

Result<Scaler> make_converter(const PixelFormat& from, const PixelFormat& to) {
  for (const PixelFormat& picture : {from, to})
    if (!has_known_matrix(picture))
      return invalid_argument("colour matrix {} of pixel format '{}' is not supported",
                              static_cast<int>(picture.matrix), name_of(picture.format));
  Scaler scaler(sws_alloc_context());
  if (!scaler) return resource_exhausted("no memory for a colour converter");
  set_formats(scaler.get(), from, to);
  if (const int error = sws_init_context(scaler.get(), nullptr, nullptr); error < 0)
    return invalid_argument("cannot convert pixel format '{}' {} x {} to '{}': {}",
                            name_of(from.format), from.width, from.height, name_of(to.format),
                            describe(error));
  // This fails for conversions without a matrix (RGB to RGB), which need none.
  sws_setColorspaceDetails(scaler.get(), coefficients(from), from.is_full_range ? 1 : 0,
                           coefficients(to), to.is_full_range ? 1 : 0, 0, 1 << 16, 1 << 16);
  return scaler;
}

}  // namespace engram::datasets::libav
