// SPDX-License-Identifier: Apache-2.0
#include "encoders/latent_block.h"

#include "encoders/coding/byte_stream.h"
#include "encoders/coding/checked_block.h"

namespace engram::encoders {

namespace {

/// The next `size` bytes.
Result<std::span<const std::byte>> take(std::span<const std::byte>& bytes, int64_t size) {
  if (size < 0 || static_cast<uint64_t>(size) > bytes.size())
    return data_loss("block of latents: found a part of {} bytes, needs at most {}", size,
                     bytes.size());
  const auto part = bytes.first(static_cast<size_t>(size));
  bytes = bytes.subspan(part.size());
  return part;
}

}  // namespace

std::vector<std::byte> LatentBlockCodec::encode(const LatentRows& rows, size_t count) const {
  ENGRAM_CHECK(rows.images.size() == images.size(), "{} images of {}", rows.images.size(),
               images.size());
  std::vector<std::vector<std::byte>> parts;
  ByteWriter writer;
  writer.put_varint(rows.scene);
  for (size_t i = 0; i < images.size(); ++i) {
    ENGRAM_CHECK(rows.images[i].size() == count * images[i].model().latents(), "{} latents",
                 rows.images[i].size());
    writer.put_varint(static_cast<int64_t>(parts.emplace_back(images[i].encode(rows.images[i])).size()));
  }
  if (numbers) parts.push_back(numbers->encode(rows.numbers));
  std::vector<std::byte> block = writer.take();
  for (const auto& part : parts) block.insert(block.end(), part.begin(), part.end());
  return with_checksum(std::move(block), count);
}

Result<LatentRows> LatentBlockCodec::decode(std::span<const std::byte> block, size_t count,
                                            size_t wanted) const {
  ENGRAM_ASSIGN_OR_RETURN(auto bytes, without_checksum(block, "block of latents", count));
  ByteReader reader(bytes);
  LatentRows rows;
  const int64_t scene = reader.get_varint();
  std::vector<int64_t> sizes(images.size());
  for (int64_t& size : sizes) size = reader.get_varint();
  if (reader.failed() || scene < 0 || scene >= static_cast<int64_t>(scenes))
    return data_loss("block of latents: found scene {}, needs 0 to {}", scene, scenes - 1);
  rows.scene = static_cast<uint32_t>(scene);
  bytes = reader.rest();
  for (size_t i = 0; i < images.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto part, take(bytes, sizes[i]));
    ENGRAM_ASSIGN_OR_RETURN(rows.images.emplace_back(), images[i].decode(part, count, wanted));
  }
  if (!numbers) return rows;
  ENGRAM_ASSIGN_OR_RETURN(rows.numbers, numbers->decode(bytes, count));
  rows.numbers.resize(wanted * numbers->model().count());
  return rows;
}

}  // namespace engram::encoders
