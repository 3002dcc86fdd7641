// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/picture_file.h"

#include <algorithm>
#include <array>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace engram::memory {

namespace {

/// What the header of a file says about its picture before it is decoded.
struct Header {
  int64_t width = 0;
  int64_t height = 0;
  /// The file has its end marker. Decoders invent the pixels that a truncated file lacks, so a file
  /// without the marker is refused.
  bool is_complete = false;
};

using Bytes = std::span<const std::byte>;

uint32_t big_endian(Bytes bytes, size_t at, size_t count) {
  uint32_t value = 0;
  for (size_t i = 0; i < count; ++i) value = value << 8 | std::to_integer<uint32_t>(bytes[at + i]);
  return value;
}

bool starts_with(Bytes bytes, std::span<const uint8_t> start) {
  return bytes.size() >= start.size() &&
         std::ranges::equal(bytes.first(start.size()), start, [](std::byte a, uint8_t b) {
           return std::to_integer<uint8_t>(a) == b;
         });
}

bool has_mark(Bytes bytes, std::string_view mark) {
  return as_text(bytes).find(mark) != std::string_view::npos;
}

std::optional<Header> png_header(Bytes bytes) {
  constexpr std::array<uint8_t, 16> kStart{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n',
                                           0,    0,   0,   13,  'I',  'H',  'D',  'R'};
  if (!starts_with(bytes, kStart) || bytes.size() < kStart.size() + 8) return std::nullopt;
  return Header{big_endian(bytes, 16, 4), big_endian(bytes, 20, 4), has_mark(bytes, "IEND")};
}

/// Reads the first frame header: SOF0 to SOF15, except three codes that have another meaning.
std::optional<Header> jpeg_header(Bytes bytes) {
  constexpr std::array<uint8_t, 2> kStart{0xff, 0xd8};
  constexpr uint32_t kHuffmanTables = 0xc4;
  constexpr uint32_t kReserved = 0xc8;
  constexpr uint32_t kArithmeticTables = 0xcc;
  if (!starts_with(bytes, kStart)) return std::nullopt;
  size_t at = kStart.size();
  while (at + 9 <= bytes.size()) {
    if (std::to_integer<uint8_t>(bytes[at]) != 0xff) return std::nullopt;
    const uint32_t code = big_endian(bytes, at + 1, 1);
    if (code == 0xff) {  // Fill byte.
      ++at;
      continue;
    }
    const bool is_frame = code >= 0xc0 && code <= 0xcf && code != kHuffmanTables &&
                          code != kReserved && code != kArithmeticTables;
    // Searches behind the frame header only: a thumbnail before it may have an end marker of its
    // own.
    if (is_frame)
      return Header{big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2),
                    has_mark(bytes.subspan(at), "\xff\xd9")};
    at += 2 + big_endian(bytes, at + 2, 2);
  }
  return std::nullopt;
}

Result<idf::NdArray> array_of(const cv::Mat& image) {
  const bool is_colour = image.type() == CV_8UC3;
  if (!is_colour && image.type() != CV_8UC1 && image.type() != CV_16UC1)
    return invalid_argument(
        "found a picture of {} channels of {} bits, needs 3 or 1 of 8 bits, or 1 of 16",
        image.channels(), 8 * image.elemSize1());
  std::vector<std::byte> plain(image.total() * image.elemSize());
  cv::Mat out(image.rows, image.cols, image.type(), plain.data());
  if (is_colour)
    cv::cvtColor(image, out, cv::COLOR_BGR2RGB);
  else
    image.copyTo(out);
  return idf::NdArray::create(
      image.depth() == CV_16U ? idf::ElementType::kUInt16 : idf::ElementType::kUInt8,
      {image.rows, image.cols, image.channels()}, Buffer::take(std::move(plain)));
}

}  // namespace

Result<idf::NdArray> read_picture(Bytes bytes, int64_t max_pixels) {
  auto header = png_header(bytes);
  if (!header) header = jpeg_header(bytes);
  if (!header || bytes.size() > std::numeric_limits<int>::max())
    return invalid_argument("is neither a PNG nor a JPEG file");
  if (header->width == 0 || header->height == 0 || header->width > max_pixels / header->height)
    return invalid_argument("is a picture of {} x {} pixels, needs 1 to {}", header->width,
                            header->height, max_pixels);
  if (!header->is_complete) return invalid_argument("is a picture that lacks its end");
  try {
    // cv::Mat has no const view; imdecode only reads it.
    const cv::Mat packed(1, static_cast<int>(bytes.size()), CV_8U,
                         const_cast<std::byte*>(bytes.data()));
    const cv::Mat image = cv::imdecode(packed, cv::IMREAD_UNCHANGED);
    if (image.empty()) return invalid_argument("is a damaged picture");
    return array_of(image);
  } catch (const cv::Exception& error) {
    return invalid_argument("is no picture: {}", error.what());
  }
}

}  // namespace engram::memory
