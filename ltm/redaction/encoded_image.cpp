// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/encoded_image.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "ltm/core/ascii.h"

namespace engram::ltm {

namespace {

using namespace std::string_view_literals;

/// Fewer bytes show nothing. Unit: bytes.
constexpr size_t kMinEncoded = 16;
/// What ROS' compressedDepth has ahead of its PNG. Unit: bytes.
constexpr size_t kDepthHeader = 12;
constexpr size_t kTransportPacket = 188;

constexpr std::array kFileBegins{
    "\xFF\xD8\xFF"sv, "\x89PNG\r\n\x1A\n"sv, "GIF87a"sv, "GIF89a"sv, "II*\0"sv, "MM\0*"sv,
    "II+\0"sv, "MM\0+"sv, "\0\0\0\x0CjP  "sv, "\0\0\0\x0CJXL "sv, "\xFF\x4F\xFF\x51"sv,
    "\xFF\x0A"sv, "\x76\x2F\x31\x01"sv, "#?RADIANCE"sv, "qoif"sv, "8BPS\0"sv, "DDS "sv,
    "\x1A\x45\xDF\xA3"sv, "DKIF"sv, "FLV\x01"sv, "\x30\x26\xB2\x75\x8E\x66\xCF\x11"sv,
    "\x80theora"sv,
    // AV1: a temporal unit begins with a delimiter of no bytes.
    "\x12\0\x0A"sv, "\x12\0\x1A"sv, "\x12\0\x22"sv, "\x12\0\x2A"sv, "\x12\0\x32"sv};

/// The same as texts, by base64.
constexpr std::array kTextBegins{"data:image/"sv, "data:video/"sv, "/9j/"sv,
                                 "iVBORw0KGgo"sv, "R0lGOD"sv,      "UklGR"sv};

/// What names of formats of images and video contain.
constexpr std::array kFormats{
    "jpeg"sv, "jpg"sv,    "png"sv,        "webp"sv,  "avif"sv, "heif"sv, "heic"sv, "tiff"sv,
    "bmp"sv,  "gif"sv,    "jxl"sv,        "j2k"sv,   "jp2"sv,  "rvl"sv,  "264"sv,  "265"sv,
    "hevc"sv, "avc"sv,    "av1"sv,        "av01"sv,  "vp8"sv,  "vp9"sv,  "mpeg"sv, "mp4"sv,
    "mpg"sv,  "theora"sv, "compressed"sv, "bayer"sv, "yuv"sv,  "nv12"sv, "nv21"sv};

bool begins_with_any(std::string_view text, std::span<const std::string_view> begins) {
  return std::ranges::any_of(begins, [&](std::string_view each) { return text.starts_with(each); });
}

uint32_t big_endian(std::string_view four) {
  uint32_t number = 0;
  for (const char byte : four.substr(0, 4)) number = number << 8 | static_cast<uint8_t>(byte);
  return number;
}

/// A start code of three or four bytes, and a unit of any kind: of H.264 and HEVC, which begin with
/// a zero bit, or of MPEG, which set it.
bool begins_with_start_code(std::string_view text) {
  return text.starts_with("\0\0\1"sv) || text.starts_with("\0\0\0\1"sv);
}

/// Units of H.264 or HEVC behind their lengths, which fill the bytes exactly.
bool is_units_with_lengths(std::string_view text) {
  while (text.size() > 4) {
    const uint32_t length = big_endian(text);
    const bool is_unit = length > 1 && length <= text.size() - 4 && (text[4] & 0x80) == 0;
    if (!is_unit) return false;
    text.remove_prefix(4 + size_t{length});
  }
  return text.empty();
}

bool is_bitmap(std::string_view text) {
  // A bitmap tells its size.
  uint32_t size = 0;
  std::memcpy(&size, text.data() + 2, sizeof(size));
  return text.starts_with("BM") && size == text.size();
}

bool is_portable_map(std::string_view text) {
  return text[0] == 'P' && text[1] >= '1' && text[1] <= '7' && text[2] == '\n';
}

bool is_transport_stream(std::string_view text) {
  return text[0] == 0x47 && text.size() > kTransportPacket && text[kTransportPacket] == 0x47;
}

bool is_container(std::string_view text) {
  const std::string_view kind = text.substr(8, 4);
  if (text.starts_with("RIFF") && (kind == "WEBP" || kind == "AVI ")) return true;
  if (text.substr(4, 4) == "ftyp") return true;  // HEIF, AVIF, MP4
  // Ogg has sound, too.
  return text.starts_with("OggS") && text.substr(0, 64).find("theora") != std::string_view::npos;
}

/// What the members of a message say.
class MessageMembers {
 public:
  explicit MessageMembers(const idf::Dict& message) {
    for (const idf::DictEntry& entry : message) add(entry);
  }

  [[nodiscard]] std::optional<std::string> image_bytes() const {
    if (bytes_ == nullptr || is_cloud_) return std::nullopt;
    if (!is_image_format_ && !(width_ > 1 && height_ > 1)) return std::nullopt;
    return *bytes_;
  }

 private:
  void add(const idf::DictEntry& entry) {
    const std::string name = lower_ascii(entry.key);
    if (name == "point_step") is_cloud_ = true;
    if (name == "width" || name == "cols") width_ = entry.value.as_number().value_or(0);
    if (name == "height" || name == "rows") height_ = entry.value.as_number().value_or(0);
    if (const auto* text = entry.value.get_if<std::string>();
        text != nullptr && (name == "format" || name == "encoding" || name == "codec"))
      is_image_format_ = is_image_format_ || std::ranges::any_of(kFormats, [&](auto format) {
                           return lower_ascii(*text).find(format) != std::string::npos;
                         });
    if (const auto* array = entry.value.get_if<idf::NdArray>();
        bytes_ == nullptr && array != nullptr && idf::size_bytes(array->type()) == 1 &&
        array->shape().size() == 1 && array->bytes().size() >= kMinEncoded)
      bytes_ = &entry.key;
  }

  double width_ = 0, height_ = 0;
  bool is_image_format_ = false;
  bool is_cloud_ = false;
  const std::string* bytes_ = nullptr;
};

}  // namespace

bool begins_as_image_or_video(std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes);
  if (text.size() < kMinEncoded) return false;
  return begins_with_any(text, kFileBegins) || begins_with_any(text, kTextBegins) ||
         begins_with_any(text.substr(kDepthHeader), std::span(kFileBegins).first(2)) ||
         begins_with_start_code(text) || is_container(text) || is_bitmap(text) ||
         is_portable_map(text) || is_transport_stream(text) || is_units_with_lengths(text);
}

std::optional<std::string> image_bytes_of(const idf::Dict& message) {
  return MessageMembers(message).image_bytes();
}

}  // namespace engram::ltm
