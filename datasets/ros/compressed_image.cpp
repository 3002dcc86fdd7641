// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/image_message.h"
#include "ltm/codec/codec.h"
#include "ltm/codec/image_file.h"
#include "ltm/codec/png.h"

namespace engram::datasets::ros {

using idf::ElementType;

idf::Data picture_of_compressed(idf::Data message) {
  const idf::Data* data = message.at("data");
  const auto* file = data == nullptr ? nullptr : data->get_if<idf::NdArray>();
  if (file == nullptr || file->type() != ElementType::kUInt8) return message;
  auto pixels = ltm::decode_image_file(file->bytes());
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
  // This is the format text that image_transport uses.
  const std::string format =
      depth != nullptr ? "16UC1; png compressed " : (is_jpeg ? "jpeg" : "png");
  return idf::Data(idf::Dict{{"header", header != nullptr ? *header : idf::Data()},
                             {"format", format},
                             {"data", std::move(bytes)}});
}

}  // namespace engram::datasets::ros
