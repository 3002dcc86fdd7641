// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/image_file.h"

#include <algorithm>
#include <optional>
#include <string>

#include "ltm/codec/codec.h"
#include "ltm/core/file.h"

namespace engram::datasets {

namespace {

using idf::ElementType;

constexpr size_t kMaxImageBytes = size_t{1} << 28;
constexpr std::string_view kPngStart = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegStart = "\xff\xd8\xff";

/// What a file announces before anything is decoded.
struct Announced {
  std::string_view codec;
  ElementType type = ElementType::kUInt8;
  idf::Shape shape;
};

/// A big-endian number of `count` bytes.
int64_t number_at(std::span<const std::byte> file, size_t at, size_t count) {
  int64_t number = 0;
  for (size_t i = 0; i < count; ++i) number = number << 8 | std::to_integer<int64_t>(file[at + i]);
  return number;
}

/// Grey or RGB without transparency and palettes.
std::optional<Announced> announced_png(std::span<const std::byte> file) {
  if (file.size() < 26) return std::nullopt;
  const int64_t bits = number_at(file, 24, 1);
  const int64_t colour = number_at(file, 25, 1);
  const bool is_known = (colour == 0 && (bits == 8 || bits == 16)) || (colour == 2 && bits == 8);
  if (!is_known) return std::nullopt;
  return Announced{"png",
                   bits == 16 ? ElementType::kUInt16 : ElementType::kUInt8,
                   {number_at(file, 20, 4), number_at(file, 16, 4), colour == 2 ? 3 : 1}};
}

/// Walks over the segments up to the one that begins the frame.
std::optional<Announced> announced_jpeg(std::span<const std::byte> file) {
  for (size_t at = 2; at + 10 <= file.size();) {
    if (number_at(file, at, 1) != 0xff) return std::nullopt;
    const int64_t marker = number_at(file, at + 1, 1);
    if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) {
      const int64_t channels = number_at(file, at + 9, 1);
      if (number_at(file, at + 4, 1) != 8 || (channels != 1 && channels != 3)) return std::nullopt;
      return Announced{"jpeg",
                       ElementType::kUInt8,
                       {number_at(file, at + 5, 2), number_at(file, at + 7, 2), channels}};
    }
    at += marker == 0xff ? 1 : 2 + static_cast<size_t>(number_at(file, at + 2, 2));
  }
  return std::nullopt;
}

std::optional<Announced> announced(std::span<const std::byte> file) {
  if (as_text(file).starts_with(kPngStart)) return announced_png(file);
  if (as_text(file).starts_with(kJpegStart)) return announced_jpeg(file);
  return std::nullopt;
}

}  // namespace

Result<idf::NdArray> read_image_file(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const Buffer file, read_file(path));
  const auto found = announced(file.bytes());
  if (!found)
    return invalid_argument("'{}': needs a PNG (grey, or RGB of 8 bits) or JPEG file",
                            path.string());
  const auto bytes = idf::size_bytes(found->type, found->shape);
  if (!bytes || *bytes > kMaxImageBytes)
    return invalid_argument("'{}': announces an image of {}, needs at most {} bytes", path.string(),
                            idf::to_string(found->shape), kMaxImageBytes);
  auto image = ltm::find_codec(found->codec)->decode(file.bytes(), found->type, found->shape);
  if (!image.ok()) return image.status().with_context(fmt::format("'{}'", path.string()));
  return image;
}

bool has_image_name(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

}  // namespace engram::datasets
