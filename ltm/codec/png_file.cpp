// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/png_file.h"

#include <spng.h>
#include <zlib.h>

#include <cstdlib>
#include <memory>
#include <string_view>

namespace engram::ltm {

namespace {

/// Max expansion of a byte by deflate. It bounds what few bytes can announce.
constexpr size_t kMaxPngExpansion = 1032;
/// Bounds what texts and colour profiles in a file may take. Unit: bytes.
constexpr size_t kMaxChunk = size_t{8} << 20;
constexpr size_t kMaxChunks = size_t{16} << 20;

/// The last chunk with its checksum, which libspng does not look at.
constexpr std::string_view kPngEnd = "IEND\xae\x42\x60\x82";

struct FreedPng {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
  void operator()(void* bytes) const { std::free(bytes); }
};

using PngContext = std::unique_ptr<spng_ctx, FreedPng>;

Status damaged_png(int error) {
  return data_loss("png: {}", spng_strerror(error));
}

/// How the pixels are decoded: the element type, the number of channels and libspng's name.
struct PngPixels {
  idf::ElementType type;
  int64_t channels;
  int format;
};

Result<PngPixels> pixels_of(const spng_ihdr& header) {
  switch (header.color_type) {
    case SPNG_COLOR_TYPE_GRAYSCALE:
      // The native order of bytes; SPNG_FMT_G8 is for up to 8 bits.
      if (header.bit_depth == 16) return PngPixels{idf::ElementType::kUInt16, 1, SPNG_FMT_PNG};
      return PngPixels{idf::ElementType::kUInt8, 1, SPNG_FMT_G8};
    case SPNG_COLOR_TYPE_INDEXED:
      return PngPixels{idf::ElementType::kUInt8, 3, SPNG_FMT_RGB8};
    case SPNG_COLOR_TYPE_TRUECOLOR:
      if (header.bit_depth == 8) return PngPixels{idf::ElementType::kUInt8, 3, SPNG_FMT_RGB8};
      return invalid_argument("png: found RGB of 16 bits, needs 8");
    default:
      return invalid_argument("png: found transparency, needs none");
  }
}

}  // namespace

Result<std::vector<std::byte>> write_png(const idf::NdArray& image, std::optional<int> level) {
  const PngContext context(spng_ctx_new(SPNG_CTX_ENCODER));
  if (!context) return resource_exhausted("png: no memory");
  spng_ihdr header{};
  header.height = static_cast<uint32_t>(image.shape()[0]);
  header.width = static_cast<uint32_t>(image.shape()[1]);
  header.bit_depth = image.type() == idf::ElementType::kUInt16 ? 16 : 8;
  header.color_type = image.shape()[2] == 3 ? SPNG_COLOR_TYPE_TRUECOLOR : SPNG_COLOR_TYPE_GRAYSCALE;
  int error = spng_set_ihdr(context.get(), &header);
  const auto set = [&](spng_option option, int value) {
    if (error == 0) error = spng_set_option(context.get(), option, value);
  };
  set(SPNG_ENCODE_TO_BUFFER, 1);
  set(SPNG_IMG_COMPRESSION_LEVEL, level.value_or(Z_BEST_SPEED));
  set(SPNG_IMG_COMPRESSION_STRATEGY, level ? Z_DEFAULT_STRATEGY : Z_RLE);
  set(SPNG_FILTER_CHOICE, level ? SPNG_FILTER_CHOICE_ALL : SPNG_FILTER_CHOICE_SUB);
  if (error == 0)
    error = spng_encode_image(context.get(), image.bytes().data(), image.bytes().size(),
                              SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  if (error != 0) return invalid_argument("png: {}", spng_strerror(error));
  size_t size = 0;
  const std::unique_ptr<void, FreedPng> file(spng_get_png_buffer(context.get(), &size, &error));
  if (!file) return resource_exhausted("png: {}", spng_strerror(error));
  const auto* begin = static_cast<const std::byte*>(file.get());
  return std::vector<std::byte>(begin, begin + size);
}

Result<idf::NdArray> read_png(std::span<const std::byte> file, int64_t max_pixels) {
  const PngContext context(spng_ctx_new(0));
  if (!context) return resource_exhausted("png: no memory");
  spng_ihdr header{};
  int error = spng_set_chunk_limits(context.get(), kMaxChunk, kMaxChunks);
  if (error == 0) error = spng_set_png_buffer(context.get(), file.data(), file.size());
  if (error == 0) error = spng_get_ihdr(context.get(), &header);
  if (error != 0) return damaged_png(error);
  if (header.width > max_pixels / header.height)
    return data_loss("png: found {} x {} pixels, needs at most {}", header.width, header.height,
                     max_pixels);
  ENGRAM_ASSIGN_OR_RETURN(const PngPixels pixels, pixels_of(header));
  size_t packed = 0;
  error = spng_decoded_image_size(context.get(), SPNG_FMT_RAW, &packed);
  if (error != 0) return damaged_png(error);
  const idf::Shape shape{header.height, header.width, pixels.channels};
  const auto size = idf::size_bytes(pixels.type, shape);
  if (!size || packed / kMaxPngExpansion > file.size())
    return data_loss("png: {} bytes hold no {} x {} pixels", file.size(), header.width,
                     header.height);
  std::vector<std::byte> plain(*size);
  error = spng_decode_image(context.get(), plain.data(), plain.size(), pixels.format, 0);
  // Reads up to the end, so that damage behind the pixels counts, too.
  if (error == 0) error = spng_decode_chunks(context.get());
  if (error != 0) return damaged_png(error);
  if (as_text(file).rfind(kPngEnd) == std::string_view::npos)
    return data_loss("png: its end is missing");
  return idf::NdArray::create(pixels.type, shape, Buffer::take(std::move(plain)));
}

}  // namespace engram::ltm
