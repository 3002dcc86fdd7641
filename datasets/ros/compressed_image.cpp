// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstring>
#include <optional>

#include "datasets/ros/image_message.h"
#include "ltm/codec/codec.h"
#include "ltm/codec/png.h"

namespace engram::datasets::ros {

namespace {

using idf::ElementType;

constexpr std::string_view kPngStart = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegStart = "\xff\xd8\xff";

/// What a picture file announces, before anything is decoded.
struct Announced {
  std::string_view format;
  ElementType type;
  idf::Shape shape;
};

uint8_t byte_at(std::span<const std::byte> file, size_t at) {
  return std::to_integer<uint8_t>(file[at]);
}
int64_t big_endian_16(std::span<const std::byte> file, size_t at) {
  return byte_at(file, at) << 8 | byte_at(file, at + 1);
}
int64_t big_endian_32(std::span<const std::byte> file, size_t at) {
  return big_endian_16(file, at) << 16 | big_endian_16(file, at + 2);
}

/// Grey or RGB without transparency and palettes.
std::optional<Announced> announced_png(std::span<const std::byte> file) {
  constexpr size_t kHeaderBytes = 26;
  if (file.size() < kHeaderBytes) return std::nullopt;
  const int bits = byte_at(file, 24);
  const int colour = byte_at(file, 25);
  const idf::Shape shape{big_endian_32(file, 20), big_endian_32(file, 16), colour == 2 ? 3 : 1};
  if (bits == 8 && (colour == 0 || colour == 2))
    return Announced{"png", ElementType::kUInt8, shape};
  if (bits == 16 && colour == 0) return Announced{"png", ElementType::kUInt16, shape};
  return std::nullopt;
}

/// Walks the segments up to the one that starts the frame.
std::optional<Announced> announced_jpeg(std::span<const std::byte> file) {
  for (size_t at = 2; at + 10 <= file.size();) {
    if (byte_at(file, at) != 0xff) return std::nullopt;
    const int marker = byte_at(file, at + 1);
    const bool is_frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (is_frame) {
      const int channels = byte_at(file, at + 9);
      if (byte_at(file, at + 4) != 8 || (channels != 1 && channels != 3)) return std::nullopt;
      return Announced{"jpeg",
                       ElementType::kUInt8,
                       {big_endian_16(file, at + 5), big_endian_16(file, at + 7), channels}};
    }
    at += marker == 0xff ? 1 : 2 + big_endian_16(file, at + 2);
  }
  return std::nullopt;
}

std::optional<Announced> announced(std::span<const std::byte> file) {
  if (as_text(file).starts_with(kPngStart)) return announced_png(file);
  if (as_text(file).starts_with(kJpegStart)) return announced_jpeg(file);
  return std::nullopt;
}

}  // namespace

idf::Data picture_of_compressed(idf::Data message) {
  const idf::Data* data = message.at("data");
  const auto* file = data == nullptr ? nullptr : data->get_if<idf::NdArray>();
  if (file == nullptr || file->type() != ElementType::kUInt8) return message;
  const auto found = announced(file->bytes());
  if (!found) return message;
  auto pixels = ltm::find_codec(found->format)->decode(file->bytes(), found->type, found->shape);
  if (!pixels.ok()) return message;
  const idf::Data* format = message.at("format");
  const bool is_depth = format != nullptr && format->is<std::string>() &&
                        format->get<std::string>().starts_with("16UC1");
  idf::Dict picture{{is_depth ? "depth" : "image", *std::move(pixels)}};
  if (const idf::Data* header = message.at("header")) picture.set("header", *header);
  return picture;
}

Result<idf::Data> compressed_of_picture(const idf::Data& value, int jpeg_quality) {
  const idf::Data* depth = value.at("depth");
  const idf::Data* found = depth != nullptr ? depth : value.at("image");
  const auto* pixels = found == nullptr ? nullptr : found->get_if<idf::NdArray>();
  if (pixels == nullptr) return value;
  ENGRAM_RETURN_IF_ERROR(check_members(value, {"image", "depth", "header"}));
  const bool is_jpeg =
      jpeg_quality > 0 && depth == nullptr && pixels->type() == ElementType::kUInt8;
  std::vector<std::byte> file;
  if (is_jpeg) {
    ENGRAM_ASSIGN_OR_RETURN(const auto codec,
                            ltm::make_codec(fmt::format("jpeg:{}", jpeg_quality)));
    ENGRAM_ASSIGN_OR_RETURN(file, codec->encode(*pixels));
  } else {
    ENGRAM_ASSIGN_OR_RETURN(file, ltm::png_codec().encode(*pixels));
  }
  const auto size = static_cast<int64_t>(file.size());
  ENGRAM_ASSIGN_OR_RETURN(
      auto bytes, idf::NdArray::create(ElementType::kUInt8, {size}, Buffer::take(std::move(file))));
  const idf::Data* header = value.at("header");
  // As image_transport says it.
  const std::string format =
      depth != nullptr ? "16UC1; png compressed " : (is_jpeg ? "jpeg" : "png");
  return idf::Data(idf::Dict{{"header", header != nullptr ? *header : idf::Data()},
                             {"format", format},
                             {"data", std::move(bytes)}});
}

}  // namespace engram::datasets::ros
