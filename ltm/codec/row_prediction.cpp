// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/row_prediction.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "ltm/codec/row_prediction_loops.h"
#include "ltm/codec/row_wavefront.h"
#include "ltm/core/check.h"

static_assert(std::endian::native == std::endian::little);

// The same loops are compiled for the oldest processor and for one with wider vectors.
// target_clones is not used because its resolvers run before a sanitizer is ready.
#if defined(__x86_64__)
#define ENGRAM_WIDE_VECTORS __attribute__((target("avx2")))
#define ENGRAM_HAS_WIDE_VECTORS() __builtin_cpu_supports("avx2")
#else
#define ENGRAM_WIDE_VECTORS
#define ENGRAM_HAS_WIDE_VECTORS() false
#endif

namespace engram::ltm {

using namespace row_loops;

namespace {

constexpr size_t kMaxChannels = 4;
constexpr size_t kSampledRows = 16;

template <typename T, size_t kChannels>
class Lines {
 public:
  explicit Lines(size_t width) : lines_(kChannels, Line<T>(width)) {}
  Rows<T, kChannels> rows() {
    Rows<T, kChannels> rows;
    for (size_t c = 0; c < kChannels; ++c) rows[c] = lines_[c].data();
    return rows;
  }
  void set_left(const Rows<T, kChannels>& above) {
    for (size_t c = 0; c < kChannels; ++c) lines_[c].set_left(above[c][0]);
  }

 private:
  std::vector<Line<T>> lines_;
};

template <typename T, size_t kChannels>
ENGRAM_INLINE void predict(const std::byte* image, const ImageSize& size, bool colour_differences,
                           std::byte* residuals) {
  const size_t width = size.width;
  const size_t plane = size.height * width;
  Lines<T, kChannels> one(width), two(width);
  Lines<T, kChannels>*current = &one, *previous = &two;
  std::vector<T> differences(width);
  for (size_t y = 0; y < size.height; ++y, std::swap(current, previous)) {
    const auto rows = current->rows();
    const auto above = previous->rows();
    split_channels<T, kChannels>(reinterpret_cast<const T*>(image) + y * width * kChannels, rows,
                                 width);
    if constexpr (std::is_same_v<T, uint32_t>)
      if (size.is_float)
        for (T* row : rows)
          for (size_t x = 0; x < width; ++x) row[x] = ordered(row[x]);
    if constexpr (kChannels >= 3)
      if (colour_differences) subtract(rows[0], rows[1], width), subtract(rows[2], rows[1], width);
    current->set_left(above);
    previous->set_left(above);
    const auto coded = in_coded_order<T, kChannels>(rows, colour_differences);
    const auto coded_above = in_coded_order<T, kChannels>(above, colour_differences);
    for (size_t c = 0; c < kChannels; ++c) {
      auto* out = reinterpret_cast<uint8_t*>(residuals) + c * sizeof(T) * plane + y * width;
      if constexpr (sizeof(T) == 1) {
        predict_line(coded[c], coded_above[c], out, width);
      } else {
        predict_line(coded[c], coded_above[c], differences.data(), width);
        split_bytes(differences.data(), out, plane, width);
      }
    }
  }
}

/// Restores single bytes in bands of sixteen rows, because along a row each number depends on the
/// previous one and cannot be vectorised (row_wavefront.h). A 640 x 480 frame takes 0.22 ms instead
/// of 0.82 ms with AVX2 (docs/codecs.md).
template <size_t kChannels>
ENGRAM_INLINE void restore_bytes(const std::byte* residuals, const ImageSize& size,
                                 bool colour_differences, std::byte* image) {
  const size_t width = size.width;
  Band<kChannels> band(width);
  for (size_t first = 0; first < size.height; first += kLanes, band.advance()) {
    const size_t count = std::min(kLanes, size.height - first);
    for (size_t c = 0; c < kChannels; ++c)
      for (size_t k = 0; k < count; ++k)
        std::memcpy(band.row(c, k), residuals + (c * size.height + first + k) * width, width);
    band.restore();
    for (size_t k = 0; k < count; ++k)
      join_pixels<kChannels>(band.rows(k), colour_differences,
                             reinterpret_cast<uint8_t*>(image) + (first + k) * width * kChannels,
                             width);
  }
}

template <typename T, size_t kChannels>
ENGRAM_INLINE void restore_words(const std::byte* residuals, const ImageSize& size,
                                 bool colour_differences, std::byte* image) {
  const size_t width = size.width;
  const size_t plane = size.height * width;
  Lines<T, kChannels> one(width), two(width), out(width), differences(width);
  auto above = in_coded_order<T, kChannels>(one.rows(), colour_differences);
  auto rows = in_coded_order<T, kChannels>(two.rows(), colour_differences);
  for (size_t y = 0; y < size.height; ++y, std::swap(above, rows)) {
    Rows<const T, kChannels> in;
    for (size_t c = 0; c < kChannels; ++c) {
      const auto* from =
          reinterpret_cast<const uint8_t*>(residuals) + c * sizeof(T) * plane + y * width;
      join_bytes(from, plane, differences.rows()[c], width);
      in[c] = differences.rows()[c];
    }
    restore_lines<T, kChannels>(in, above, rows, width);
    const auto plain = out.rows();
    const auto pixels = in_coded_order<T, kChannels>(rows, colour_differences);
    for (size_t c = 0; c < kChannels; ++c) std::memcpy(plain[c], pixels[c], width * sizeof(T));
    if constexpr (kChannels >= 3)
      if (colour_differences) add(plain[0], plain[1], width), add(plain[2], plain[1], width);
    if constexpr (std::is_same_v<T, uint32_t>)
      if (size.is_float)
        for (T* row : plain)
          for (size_t x = 0; x < width; ++x) row[x] = unordered(row[x]);
    join_channels<T, kChannels>(plain, reinterpret_cast<T*>(image) + y * width * kChannels, width);
  }
}

template <typename T, size_t kChannels>
ENGRAM_INLINE void restore(const std::byte* residuals, const ImageSize& size,
                           bool colour_differences, std::byte* image) {
  if constexpr (sizeof(T) == 1)
    restore_bytes<kChannels>(residuals, size, colour_differences, image);
  else
    restore_words<T, kChannels>(residuals, size, colour_differences, image);
}

struct Kernels {
  decltype(&predict<uint8_t, 1>) predict;
  decltype(&restore<uint8_t, 1>) restore;
};

template <typename T, size_t kChannels>
struct Wide {
  ENGRAM_WIDE_VECTORS static void run_predict(const std::byte* image, const ImageSize& size,
                                              bool colour_differences, std::byte* residuals) {
    predict<T, kChannels>(image, size, colour_differences, residuals);
  }
  ENGRAM_WIDE_VECTORS static void run_restore(const std::byte* residuals, const ImageSize& size,
                                              bool colour_differences, std::byte* image) {
    restore<T, kChannels>(residuals, size, colour_differences, image);
  }
};

template <typename T, size_t kChannels>
struct Plain {
  static void run_predict(const std::byte* image, const ImageSize& size, bool colour_differences,
                          std::byte* residuals) {
    predict<T, kChannels>(image, size, colour_differences, residuals);
  }
  static void run_restore(const std::byte* residuals, const ImageSize& size,
                          bool colour_differences, std::byte* image) {
    restore<T, kChannels>(residuals, size, colour_differences, image);
  }
};

template <template <typename, size_t> class Code, typename T>
constexpr std::array<Kernels, kMaxChannels> kKernels{{
    {Code<T, 1>::run_predict, Code<T, 1>::run_restore},
    {Code<T, 2>::run_predict, Code<T, 2>::run_restore},
    {Code<T, 3>::run_predict, Code<T, 3>::run_restore},
    {Code<T, 4>::run_predict, Code<T, 4>::run_restore},
}};

template <template <typename, size_t> class Code>
const Kernels& kernels_of(const ImageSize& size) {
  switch (size.element_bytes) {
    case 1:
      return kKernels<Code, uint8_t>[size.channels - 1];
    case 2:
      return kKernels<Code, uint16_t>[size.channels - 1];
    default:
      return kKernels<Code, uint32_t>[size.channels - 1];
  }
}

const Kernels& kernels_of(const ImageSize& size, Vectors vectors) {
  ENGRAM_CHECK(size.channels >= 1 && size.channels <= kMaxChannels, "{} channels", size.channels);
  ENGRAM_CHECK(size.element_bytes == 1 || size.element_bytes == 2 || size.element_bytes == 4,
               "{} bytes", size.element_bytes);
  const bool is_wide = vectors == Vectors::kWidest && ENGRAM_HAS_WIDE_VECTORS();
  return is_wide ? kernels_of<Wide>(size) : kernels_of<Plain>(size);
}

/// Sum of the distances of byte residuals from zero. It is a cheap estimate of their compressed
/// size.
size_t cost(std::span<const std::byte> residuals) {
  size_t sum = 0;
  for (const std::byte residual : residuals) {
    const auto value = static_cast<uint8_t>(residual);
    sum += std::min<size_t>(value, 256u - value);
  }
  return sum;
}

}  // namespace

// A few pairs of rows decide for the whole image, since predicting all of it both ways would double
// the cost of prediction.
bool prefers_colour_differences(std::span<const std::byte> image, const ImageSize& size) {
  if (size.channels < 3 || size.height == 0) return false;
  if (size.is_float) return false;
  ImageSize strip = size;
  strip.height = std::min<size_t>(2, size.height);
  std::vector<std::byte> residuals(strip.bytes());
  const size_t line = strip.bytes() / strip.height;
  size_t with = 0, without = 0;
  const size_t step = std::max<size_t>(1, (size.height - strip.height) / kSampledRows);
  for (size_t y = 0; y + strip.height <= size.height; y += step) {
    const auto rows = image.subspan(y * line, strip.bytes());
    predict_rows(rows, strip, true, residuals);
    with += cost(residuals);
    predict_rows(rows, strip, false, residuals);
    without += cost(residuals);
  }
  return with < without;
}

void predict_rows(std::span<const std::byte> image, const ImageSize& size, bool colour_differences,
                  std::span<std::byte> residuals, Vectors vectors) {
  ENGRAM_CHECK(image.size() == size.bytes() && residuals.size() == size.bytes(), "{}, {}, {} bytes",
               image.size(), residuals.size(), size.bytes());
  kernels_of(size, vectors).predict(image.data(), size, colour_differences, residuals.data());
}

void restore_rows(std::span<const std::byte> residuals, const ImageSize& size,
                  bool colour_differences, std::span<std::byte> image, Vectors vectors) {
  ENGRAM_CHECK(image.size() == size.bytes() && residuals.size() == size.bytes(), "{}, {}, {} bytes",
               image.size(), residuals.size(), size.bytes());
  kernels_of(size, vectors).restore(residuals.data(), size, colour_differences, image.data());
}

}  // namespace engram::ltm
