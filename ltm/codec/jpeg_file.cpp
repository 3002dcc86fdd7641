// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/jpeg_file.h"

#include <turbojpeg.h>

#include <memory>
#include <type_traits>

namespace engram::ltm {

namespace {

struct FreedJpeg {
  void operator()(void* handle) const { tjDestroy(handle); }
  void operator()(unsigned char* bytes) const { tjFree(bytes); }
};

using JpegHandle = std::unique_ptr<std::remove_pointer_t<tjhandle>, FreedJpeg>;

/// Max expansion of a byte: a block of 8 x 8 takes at least this share of a byte in the densest
/// progressive file. It bounds what few bytes can announce.
constexpr size_t kMaxJpegExpansion = 4096;
/// The accurate transform. Without it libjpeg-turbo takes the fast one below quality 96.
constexpr int kAccurate = TJFLAG_ACCURATEDCT;

const unsigned char* chars_of(std::span<const std::byte> bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

}  // namespace

Result<std::vector<std::byte>> write_jpeg(const idf::NdArray& image, int quality) {
  const JpegHandle handle(tjInitCompress());
  if (!handle) return resource_exhausted("jpeg: no memory");
  const bool is_grey = image.shape()[2] == 1;
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int status =
      tjCompress2(handle.get(), chars_of(image.bytes()), static_cast<int>(image.shape()[1]), 0,
                  static_cast<int>(image.shape()[0]), is_grey ? TJPF_GRAY : TJPF_RGB, &bytes, &size,
                  is_grey ? TJSAMP_GRAY : TJSAMP_420, quality, kAccurate);
  const std::unique_ptr<unsigned char, FreedJpeg> file(bytes);
  if (status != 0) return invalid_argument("jpeg: {}", tjGetErrorStr2(handle.get()));
  const auto* begin = reinterpret_cast<const std::byte*>(bytes);
  return std::vector<std::byte>(begin, begin + size);
}

Result<idf::NdArray> read_jpeg(std::span<const std::byte> file, int64_t max_pixels) {
  const JpegHandle handle(tjInitDecompress());
  if (!handle) return resource_exhausted("jpeg: no memory");
  const auto is_damaged = [&handle](int status) {
    // A camera that writes a byte too many between segments gets a warning, and its image.
    return status != 0 && tjGetErrorCode(handle.get()) != TJERR_WARNING;
  };
  int width = 0;
  int height = 0;
  int sampling = 0;
  int colours = -1;
  const int header = tjDecompressHeader3(handle.get(), chars_of(file), file.size(), &width, &height,
                                         &sampling, &colours);
  // Which of its names the sampling has, libjpeg-turbo need not know to decode it.
  const bool is_unnamed = sampling < 0 && colours >= 0;
  if (is_damaged(header) && !is_unnamed) return data_loss("jpeg: {}", tjGetErrorStr2(handle.get()));
  if (width < 1 || height < 1 || width > max_pixels / height)
    return data_loss("jpeg: found {} x {} pixels, needs 1 to {}", width, height, max_pixels);
  if (colours == TJCS_CMYK || colours == TJCS_YCCK)
    return invalid_argument("jpeg: found CMYK, needs RGB or grey");
  const bool is_grey = colours == TJCS_GRAY;
  const idf::Shape shape{height, width, is_grey ? 1 : 3};
  const auto size = idf::size_bytes(idf::ElementType::kUInt8, shape);
  if (!size || *size / kMaxJpegExpansion > file.size())
    return data_loss("jpeg: {} bytes hold no {} x {} pixels", file.size(), width, height);
  std::vector<std::byte> plain(*size);
  const int status = tjDecompress2(handle.get(), chars_of(file), file.size(),
                                   reinterpret_cast<unsigned char*>(plain.data()), width, 0, height,
                                   is_grey ? TJPF_GRAY : TJPF_RGB, kAccurate | TJFLAG_LIMITSCANS);
  if (is_damaged(status)) return data_loss("jpeg: {}", tjGetErrorStr2(handle.get()));
  return idf::NdArray::create(idf::ElementType::kUInt8, shape, Buffer::take(std::move(plain)));
}

}  // namespace engram::ltm
