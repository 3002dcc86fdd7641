// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/bag_compression.h"

#include <bzlib.h>

#include <algorithm>
#include <memory>

#include "datasets/recordings/lz4_frame.h"
#include "datasets/rosbag/bag_records.h"

namespace engram::datasets::rosbag {

namespace {

/// bzip2 reads through pointers that are not const.
char* bytes_in(std::span<const std::byte> bytes) {
  return const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
}

struct Bz2Deleter {
  void operator()(bz_stream* stream) const {
    BZ2_bzDecompressEnd(stream);
    delete stream;
  }
};

Result<Buffer> decompress_bz2(std::span<const std::byte> bytes, uint64_t size) {
  auto made = std::make_unique<bz_stream>();
  if (const int code = BZ2_bzDecompressInit(made.get(), 0, 0); code != BZ_OK)
    return resource_exhausted("bz2: error {}", code);
  const std::unique_ptr<bz_stream, Bz2Deleter> stream(made.release());
  stream->next_in = bytes_in(bytes);
  stream->avail_in = static_cast<unsigned int>(bytes.size());
  std::vector<std::byte> out;
  for (int code = BZ_OK; code != BZ_STREAM_END;) {
    const size_t filled = out.size();
    if (filled == size && stream->avail_in == 0) break;
    // One byte more than the stated size is requested, to detect data that are too long.
    constexpr size_t kStepBytes = 1 << 16;
    out.resize(std::min<uint64_t>(size + 1, filled + std::max(filled, kStepBytes)));
    if (out.size() == filled) return data_loss("bz2: has more than the {} bytes it says", size);
    stream->next_out = reinterpret_cast<char*>(out.data() + filled);
    stream->avail_out = static_cast<unsigned int>(out.size() - filled);
    const unsigned int left = stream->avail_in;
    code = BZ2_bzDecompress(stream.get());
    const size_t produced = out.size() - filled - stream->avail_out;
    out.resize(filled + produced);
    if (code != BZ_OK && code != BZ_STREAM_END) return data_loss("bz2: error {}", code);
    if (code == BZ_OK && produced == 0 && stream->avail_in == left) break;
  }
  if (out.size() != size)
    return data_loss("bz2: holds {} bytes, the chunk says {}", out.size(), size);
  return Buffer::take(std::move(out));
}

Result<Buffer> decompress_lz4_buffer(std::span<const std::byte> bytes, uint64_t size) {
  if (size > bytes.size() * kMaxLz4Expansion)
    return data_loss("{} bytes of lz4 hold no {} bytes", bytes.size(), size);
  // The memory is not set to zero, so a false size costs nothing until it is filled.
  const std::shared_ptr<std::byte[]> plain(new std::byte[size]);
  const std::span<std::byte> out(plain.get(), size);
  ENGRAM_RETURN_IF_ERROR(decompress_lz4(bytes, out));
  return Buffer(plain, out);
}

Result<std::string> compress_bz2(std::span<const std::byte> bytes) {
  constexpr int kBlockSize = 9;  // Unit: 100 kB.
  // This is the maximum size that the manual of bzip2 states.
  std::string out(bytes.size() + bytes.size() / 100 + 600, '\0');
  auto size = static_cast<unsigned int>(out.size());
  const int code =
      BZ2_bzBuffToBuffCompress(out.data(), &size, bytes_in(bytes),
                               static_cast<unsigned int>(bytes.size()), kBlockSize, 0, 0);
  if (code != BZ_OK) return resource_exhausted("bz2: error {}", code);
  out.resize(size);
  return out;
}

}  // namespace

Status check_compression(std::string_view compression) {
  if (compression == "none" || compression == "bz2" || compression == "lz4") return {};
  return invalid_argument("compression '{}', needs 'none', 'bz2' or 'lz4'", compression);
}

Result<std::string> compress(std::string_view compression, std::span<const std::byte> bytes) {
  ENGRAM_RETURN_IF_ERROR(check_compression(compression));
  if (compression == "bz2") return compress_bz2(bytes);
  if (compression == "lz4")
    return compress_lz4(bytes, {.has_independent_blocks = true, .has_checksum = true});
  return std::string(as_text(bytes));
}

Result<Buffer> decompress(std::string_view compression, std::span<const std::byte> bytes,
                          uint64_t size) {
  ENGRAM_RETURN_IF_ERROR(check_compression(compression));
  if (size > kMaxRecordBytes)
    return data_loss("chunk of {} bytes, needs at most {}", size, kMaxRecordBytes);
  if (compression == "bz2") return decompress_bz2(bytes, size);
  if (compression == "lz4") return decompress_lz4_buffer(bytes, size);
  if (bytes.size() != size) return data_loss("chunk has {} bytes, says {}", bytes.size(), size);
  return Buffer::copy(bytes);
}

}  // namespace engram::datasets::rosbag
