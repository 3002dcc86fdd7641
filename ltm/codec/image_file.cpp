// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/image_file.h"

#include "ltm/codec/codec.h"
#include "ltm/codec/jpeg_file.h"
#include "ltm/codec/png_file.h"
#include "ltm/core/buffer.h"

namespace engram::ltm {

namespace {

using idf::ElementType;

constexpr size_t kMaxImageBytes = size_t{1} << 28;
constexpr std::string_view kPngStart = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegStart = "\xff\xd8\xff";
constexpr std::string_view kJpegEnd = "\xff\xd9";

/// A big-endian number of `count` bytes.
int64_t number_at(std::span<const std::byte> file, size_t at, size_t count) {
  int64_t number = 0;
  for (size_t i = 0; i < count; ++i) number = number << 8 | std::to_integer<int64_t>(file[at + i]);
  return number;
}

std::optional<AnnouncedImage> announced_png(std::span<const std::byte> file) {
  if (file.size() < 26) return std::nullopt;
  const int64_t bits = number_at(file, 24, 1);
  const int64_t colour = number_at(file, 25, 1);
  const bool is_known = (colour == 0 && (bits == 8 || bits == 16)) || (colour == 2 && bits == 8);
  if (!is_known) return std::nullopt;
  return AnnouncedImage{"png",
                        bits == 16 ? ElementType::kUInt16 : ElementType::kUInt8,
                        {number_at(file, 20, 4), number_at(file, 16, 4), colour == 2 ? 3 : 1}};
}

/// Where the segment begins that begins the frame (SOF).
std::optional<size_t> jpeg_frame(std::span<const std::byte> file) {
  for (size_t at = 2; at + 10 <= file.size();) {
    if (number_at(file, at, 1) != 0xff) return std::nullopt;
    const int64_t marker = number_at(file, at + 1, 1);
    if (marker == 0xff) {  // Padding.
      ++at;
      continue;
    }
    if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc)
      return at;
    const int64_t length = number_at(file, at + 2, 2);
    if (marker < 0xc0 || length < 2) return std::nullopt;
    at += 2 + static_cast<size_t>(length);
  }
  return std::nullopt;
}

std::optional<AnnouncedImage> announced_jpeg(std::span<const std::byte> file) {
  const auto frame = jpeg_frame(file);
  if (!frame) return std::nullopt;
  const int64_t channels = number_at(file, *frame + 9, 1);
  if (number_at(file, *frame + 4, 1) != 8 || (channels != 1 && channels != 3)) return std::nullopt;
  return AnnouncedImage{"jpeg",
                        ElementType::kUInt8,
                        {number_at(file, *frame + 5, 2), number_at(file, *frame + 7, 2), channels}};
}

/// Decoders invent what a truncated file lacks. A thumbnail ahead of the frame has an end of its
/// own.
bool has_jpeg_end(std::span<const std::byte> file) {
  const auto frame = jpeg_frame(file);
  return frame && as_text(file.subspan(*frame)).find(kJpegEnd) != std::string_view::npos;
}

}  // namespace

std::optional<AnnouncedImage> announced_image(std::span<const std::byte> file) {
  if (as_text(file).starts_with(kPngStart)) return announced_png(file);
  if (as_text(file).starts_with(kJpegStart)) return announced_jpeg(file);
  return std::nullopt;
}

Result<idf::NdArray> decode_image_file(std::span<const std::byte> file) {
  const auto found = announced_image(file);
  if (!found)
    return invalid_argument("needs a PNG (grey, or RGB of 8 bits) or JPEG file, found {} bytes",
                            file.size());
  const auto bytes = idf::size_bytes(found->type, found->shape);
  if (!bytes || *bytes > kMaxImageBytes)
    return invalid_argument("announces an image of {}, needs at most {} bytes",
                            idf::to_string(found->shape), kMaxImageBytes);
  return find_codec(found->codec)->decode(file, found->type, found->shape);
}

Result<idf::NdArray> decode_any_image_file(std::span<const std::byte> file, int64_t max_pixels) {
  if (as_text(file).starts_with(kPngStart)) return read_png(file, max_pixels);
  if (as_text(file).starts_with(kJpegStart) && !has_jpeg_end(file))
    return data_loss("jpeg: its end is missing");
  if (as_text(file).starts_with(kJpegStart)) return read_jpeg(file, max_pixels);
  return invalid_argument("needs a PNG or JPEG file, found {} bytes", file.size());
}

}  // namespace engram::ltm
