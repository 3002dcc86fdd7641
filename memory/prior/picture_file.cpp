// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/picture_file.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "ltm/codec/image_file.h"

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

}  // namespace

Result<idf::NdArray> read_picture(Bytes bytes, int64_t max_pixels) {
  auto header = png_header(bytes);
  if (!header) header = jpeg_header(bytes);
  if (!header) return invalid_argument("is neither a PNG nor a JPEG file");
  if (header->width == 0 || header->height == 0 || header->width > max_pixels / header->height)
    return invalid_argument("is a picture of {} x {} pixels, needs 1 to {}", header->width,
                            header->height, max_pixels);
  if (!header->is_complete) return invalid_argument("is a picture that lacks its end");
  auto image = ltm::decode_any_image_file(bytes, max_pixels);
  if (!image.ok()) return invalid_argument("is no picture to take: {}", image.status().message());
  return image;
}

}  // namespace engram::memory
