// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/picture.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

#include <algorithm>
#include <cstring>

namespace engram::ltm {

namespace {

constexpr int kAlignment = 64;
constexpr int kHalf = 1 << 15;
constexpr int kDeepMax = 1023;
constexpr int kDeepHalf = 1 << 19;
constexpr int kFromDeep = 261376;  // 255 / 1023, in 1 / 2^20.

uint8_t clamp(int value) {
  return static_cast<uint8_t>(std::clamp(value, 0, 255));
}

uint16_t clamp_deep(int value) {
  return static_cast<uint16_t>(std::clamp(value, 0, kDeepMax));
}

uint8_t* row_of(const AVFrame& picture, int plane, int64_t y) {
  return picture.data[plane] + y * picture.linesize[plane];
}

uint16_t* deep_row_of(const AVFrame& picture, int plane, int64_t y) {
  // Planes and their lines are aligned to far more than two bytes.
  return reinterpret_cast<uint16_t*>(row_of(picture, plane, y));
}

/// BT.601, in integers of 1/65536. Integer arithmetic gives the same bytes on every processor.
void to_ycc(const uint8_t* rgb, int64_t width, uint8_t* luma, uint8_t* blue, uint8_t* red) {
  for (int64_t x = 0; x < width; ++x) {
    const int r = rgb[3 * x], g = rgb[3 * x + 1], b = rgb[3 * x + 2];
    luma[x] = static_cast<uint8_t>((19595 * r + 38470 * g + 7471 * b + kHalf) >> 16);
    blue[x] = clamp(128 + ((-11059 * r - 21709 * g + 32768 * b + kHalf) >> 16));
    red[x] = clamp(128 + ((32768 * r - 27439 * g - 5329 * b + kHalf) >> 16));
  }
}

void from_ycc(const uint8_t* luma, const uint8_t* blue, const uint8_t* red, int64_t width,
              uint8_t* rgb) {
  for (int64_t x = 0; x < width; ++x) {
    const int y = luma[x], b = blue[x] - 128, r = red[x] - 128;
    rgb[3 * x] = clamp(y + ((91881 * r + kHalf) >> 16));
    rgb[3 * x + 1] = clamp(y + ((-22554 * b - 46802 * r + kHalf) >> 16));
    rgb[3 * x + 2] = clamp(y + ((116130 * b + kHalf) >> 16));
  }
}

/// As to_ycc with numbers up to 1023: the factors are 1023 / 255 times as large.
void to_deep_ycc(const uint8_t* rgb, int64_t width, uint16_t* luma, uint16_t* blue, uint16_t* red) {
  for (int64_t x = 0; x < width; ++x) {
    const int r = rgb[3 * x], g = rgb[3 * x + 1], b = rgb[3 * x + 2];
    luma[x] = clamp_deep((78611 * r + 154331 * g + 29972 * b + kHalf) >> 16);
    blue[x] = clamp_deep(512 + ((-44363 * r - 87094 * g + 131457 * b + kHalf) >> 16));
    red[x] = clamp_deep(512 + ((131457 * r - 110079 * g - 21378 * b + kHalf) >> 16));
  }
}

/// In integers of 1 / 2^20, which hold 255 / 1023 exactly enough. The sums of numbers of ten bits
/// fit 31 bits, and a damaged stream must not give larger ones. A scattered read converts all
/// pictures up to its own, so each colour of some pixels is computed in a loop of its own, which
/// compilers turn into vectors.
[[gnu::always_inline]] inline void from_deep_ycc_in_blocks(const uint16_t* luma,
                                                           const uint16_t* blue,
                                                           const uint16_t* red, int64_t width,
                                                           uint8_t* rgb) {
  constexpr int64_t kBlock = 128;
  uint8_t reds[kBlock], greens[kBlock], blues[kBlock];
  for (int64_t from = 0; from < width; from += kBlock) {
    const int64_t count = std::min(kBlock, width - from);
    for (int64_t x = 0; x < count; ++x) {
      const int y = kFromDeep * (luma[from + x] & kDeepMax) + kDeepHalf;
      const int b = (blue[from + x] & kDeepMax) - 512, r = (red[from + x] & kDeepMax) - 512;
      reds[x] = clamp((y + 366450 * r) >> 20);
      greens[x] = clamp((y - 89949 * b - 186658 * r) >> 20);
      blues[x] = clamp((y + 463159 * b) >> 20);
    }
    uint8_t* out = rgb + 3 * from;
    for (int64_t x = 0; x < count; ++x) {
      out[3 * x] = reds[x];
      out[3 * x + 1] = greens[x];
      out[3 * x + 2] = blues[x];
    }
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void from_deep_ycc_wide(const uint16_t* luma, const uint16_t* blue,
                                                        const uint16_t* red, int64_t width,
                                                        uint8_t* rgb) {
  from_deep_ycc_in_blocks(luma, blue, red, width, rgb);
}
#endif

void from_deep_ycc(const uint16_t* luma, const uint16_t* blue, const uint16_t* red, int64_t width,
                   uint8_t* rgb) {
#if defined(__x86_64__)
  static const bool is_wide = __builtin_cpu_supports("avx2");
  if (is_wide) return from_deep_ycc_wide(luma, blue, red, width, rgb);
#endif
  from_deep_ycc_in_blocks(luma, blue, red, width, rgb);
}

void to_deep_gray(const uint8_t* gray, int64_t width, uint16_t* out) {
  for (int64_t x = 0; x < width; ++x) out[x] = clamp_deep((262914 * gray[x] + kHalf) >> 16);
}

void from_deep_gray(const uint16_t* in, int64_t width, uint8_t* gray) {
  for (int64_t x = 0; x < width; ++x)
    gray[x] = clamp((kFromDeep * (in[x] & kDeepMax) + kDeepHalf) >> 20);
}

void to_bgr0(const uint8_t* rgb, int64_t width, uint8_t* out) {
  for (int64_t x = 0; x < width; ++x) {
    out[4 * x] = rgb[3 * x + 2];
    out[4 * x + 1] = rgb[3 * x + 1];
    out[4 * x + 2] = rgb[3 * x];
    out[4 * x + 3] = 0;
  }
}

void from_bgr0(const uint8_t* in, int64_t width, uint8_t* rgb) {
  for (int64_t x = 0; x < width; ++x) {
    rgb[3 * x] = in[4 * x + 2];
    rgb[3 * x + 1] = in[4 * x + 1];
    rgb[3 * x + 2] = in[4 * x];
  }
}

bool holds(AVPixelFormat format, PictureLayout layout) {
  switch (layout) {
    case PictureLayout::kGray8:
      // Some decoders add colour planes to a grey picture.
      return format == AV_PIX_FMT_GRAY8 || format == AV_PIX_FMT_YUV420P ||
             format == AV_PIX_FMT_YUVJ420P;
    case PictureLayout::kYcc444:
      return format == AV_PIX_FMT_YUV444P || format == AV_PIX_FMT_YUVJ444P;
    case PictureLayout::kGray8Deep:
      return format == AV_PIX_FMT_GRAY10 || format == AV_PIX_FMT_YUV420P10;
    default:
      return format == pixel_format(layout);
  }
}

void read_row(const AVFrame& picture, PictureLayout layout, int64_t y, int64_t width,
              uint8_t* out) {
  switch (layout) {
    case PictureLayout::kGray8:
      std::memcpy(out, row_of(picture, 0, y), static_cast<size_t>(width));
      break;
    case PictureLayout::kGray16:
      std::memcpy(out, row_of(picture, 0, y), static_cast<size_t>(2 * width));
      break;
    case PictureLayout::kRgb:
      from_bgr0(row_of(picture, 0, y), width, out);
      break;
    case PictureLayout::kYcc444:
      from_ycc(row_of(picture, 0, y), row_of(picture, 1, y), row_of(picture, 2, y), width, out);
      break;
    case PictureLayout::kYcc444Deep:
      from_deep_ycc(deep_row_of(picture, 0, y), deep_row_of(picture, 1, y),
                    deep_row_of(picture, 2, y), width, out);
      break;
    case PictureLayout::kGray8Deep:
      from_deep_gray(deep_row_of(picture, 0, y), width, out);
      break;
  }
}

void write_row(const uint8_t* in, PictureLayout layout, int64_t y, int64_t width,
               const AVFrame& picture) {
  switch (layout) {
    case PictureLayout::kGray8:
      std::memcpy(row_of(picture, 0, y), in, static_cast<size_t>(width));
      break;
    case PictureLayout::kGray16:
      std::memcpy(row_of(picture, 0, y), in, static_cast<size_t>(2 * width));
      break;
    case PictureLayout::kRgb:
      to_bgr0(in, width, row_of(picture, 0, y));
      break;
    case PictureLayout::kYcc444:
      to_ycc(in, width, row_of(picture, 0, y), row_of(picture, 1, y), row_of(picture, 2, y));
      break;
    case PictureLayout::kYcc444Deep:
      to_deep_ycc(in, width, deep_row_of(picture, 0, y), deep_row_of(picture, 1, y),
                  deep_row_of(picture, 2, y));
      break;
    case PictureLayout::kGray8Deep:
      to_deep_gray(in, width, deep_row_of(picture, 0, y));
      break;
  }
}

}  // namespace

std::optional<PictureLayout> layout_of(idf::ElementType type, const idf::Shape& shape,
                                       bool keeps_rgb) {
  if (shape.size() != 3) return std::nullopt;
  if (type == idf::ElementType::kUInt16 && shape[2] == 1) return PictureLayout::kGray16;
  if (type != idf::ElementType::kUInt8) return std::nullopt;
  if (shape[2] == 1) return PictureLayout::kGray8;
  if (shape[2] != 3) return std::nullopt;
  return keeps_rgb ? PictureLayout::kRgb : PictureLayout::kYcc444;
}

PictureLayout deep(PictureLayout layout) {
  if (layout == PictureLayout::kYcc444) return PictureLayout::kYcc444Deep;
  return layout == PictureLayout::kGray8 ? PictureLayout::kGray8Deep : layout;
}

PictureLayout shallow(PictureLayout layout) {
  if (layout == PictureLayout::kYcc444Deep) return PictureLayout::kYcc444;
  return layout == PictureLayout::kGray8Deep ? PictureLayout::kGray8 : layout;
}

AVPixelFormat pixel_format(PictureLayout layout) {
  switch (layout) {
    case PictureLayout::kGray8:
      return AV_PIX_FMT_GRAY8;
    case PictureLayout::kGray16:
      return AV_PIX_FMT_GRAY16LE;
    case PictureLayout::kRgb:
      return AV_PIX_FMT_BGR0;
    case PictureLayout::kYcc444Deep:
      return AV_PIX_FMT_YUV444P10;
    case PictureLayout::kGray8Deep:
      return AV_PIX_FMT_GRAY10;
    case PictureLayout::kYcc444:
      break;
  }
  return AV_PIX_FMT_YUV444P;
}

Result<libav::Owned<AVFrame>> make_picture(PictureLayout layout, const idf::Shape& shape) {
  libav::Owned<AVFrame> picture(av_frame_alloc());
  if (!picture) return resource_exhausted("no memory for a picture");
  picture->format = pixel_format(layout);
  picture->height = static_cast<int>(shape[0]);
  picture->width = static_cast<int>(shape[1]);
  picture->color_range = AVCOL_RANGE_JPEG;
  picture->colorspace =
      shallow(layout) == PictureLayout::kYcc444 ? AVCOL_SPC_SMPTE170M : AVCOL_SPC_UNSPECIFIED;
  if (av_frame_get_buffer(picture.get(), kAlignment) < 0)
    return resource_exhausted("no memory for a picture of {} x {}", shape[1], shape[0]);
  return picture;
}

void write_picture(const idf::NdArray& array, PictureLayout layout, AVFrame& picture) {
  const auto* bytes = reinterpret_cast<const uint8_t*>(array.bytes().data());
  const int64_t line = static_cast<int64_t>(array.bytes().size()) / array.shape()[0];
  for (int64_t y = 0; y < array.shape()[0]; ++y)
    write_row(bytes + y * line, layout, y, array.shape()[1], picture);
}

Result<idf::NdArray> read_picture(const AVFrame& picture, PictureLayout layout,
                                  idf::ElementType type, const idf::Shape& shape) {
  const auto format = static_cast<AVPixelFormat>(picture.format);
  if (picture.height != shape[0] || picture.width != shape[1] || !holds(format, layout)) {
    const char* name = av_get_pix_fmt_name(format);
    return data_loss("a picture is {} x {} of '{}', needs {} {}", picture.width, picture.height,
                     name == nullptr ? "unknown" : name, to_string(type), idf::to_string(shape));
  }
  std::vector<std::byte> plain(*idf::size_bytes(type, shape));
  const int64_t line = static_cast<int64_t>(plain.size()) / shape[0];
  for (int64_t y = 0; y < shape[0]; ++y)
    read_row(picture, layout, y, shape[1], reinterpret_cast<uint8_t*>(plain.data()) + y * line);
  return idf::NdArray::create(type, shape, Buffer::take(std::move(plain)));
}

}  // namespace engram::ltm
