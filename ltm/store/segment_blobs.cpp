// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_blobs.h"

#include <algorithm>
#include <optional>

#include "ltm/codec/zstd.h"
#include "ltm/codec/zstd_dictionary.h"
#include "ltm/idf/binary.h"
#include "ltm/store/checksum.h"
#include "ltm/store/segment_format.h"

namespace engram::ltm {

namespace {

constexpr int kRemainderLevel = 12;
/// A dictionary is tried for at least kMinBlocks blocks whose mean packed size is below
/// kMaxMeanBytes.
constexpr size_t kMinBlocks = 64;
constexpr size_t kMaxMeanBytes = 4096;
/// Approximate number of blocks, evenly chosen, from which a dictionary is trained.
constexpr size_t kSamples = 512;
/// Approximate size of a dictionary's dataset besides its bytes.
constexpr uint64_t kDatasetBytes = 512;

/// Size of the dictionary: about a hundredth of the plain data pays off.
size_t dictionary_bytes(const std::vector<Buffer>& blocks) {
  uint64_t plain = 0;
  for (const Buffer& block : blocks) plain += block.size();
  return std::clamp<uint64_t>(plain / 100, 256, 16 << 10);
}

/// A dictionary trained on the blocks, or nullopt if it is not worth trying.
std::optional<ZstdDictionary> trained_dictionary(const std::vector<Buffer>& blocks,
                                                 uint64_t packed_bytes) {
  if (blocks.size() < kMinBlocks || packed_bytes / blocks.size() >= kMaxMeanBytes)
    return std::nullopt;
  const size_t step = std::max<size_t>(blocks.size() / kSamples, 1);
  std::vector<Buffer> samples;
  for (size_t i = 0; i < blocks.size(); i += step) samples.push_back(blocks[i]);
  auto dictionary = ZstdDictionary::train(
      samples, {.max_bytes = dictionary_bytes(blocks), .level = kRemainderLevel});
  // Training fails on blocks that have nothing in common.
  return dictionary.ok() ? std::optional(*std::move(dictionary)) : std::nullopt;
}

template <typename Compress>
BlobColumn pack_blocks(const std::vector<Buffer>& blocks, const Compress& compress) {
  BlobColumn blobs;
  for (const Buffer& block : blocks) blobs.append(compress(block.bytes()));
  return blobs;
}

}  // namespace

void BlobColumn::append(std::span<const std::byte> blob) {
  bytes_.insert(bytes_.end(), blob.begin(), blob.end());
  offsets_.push_back(bytes_.size());
  checksums_.push_back(blob.empty() ? 0 : checksum(blob));
}

Status BlobColumn::write(h5::File& file, const std::string& group) const {
  const uint64_t count = bytes_.size();
  ENGRAM_RETURN_IF_ERROR(file.write(group + "/bytes", h5::Type::kUInt8, {&count, 1}, bytes_,
                                    h5::Storage::kContiguous));
  ENGRAM_RETURN_IF_ERROR(write_column(file, group + "/offset", offsets_));
  return write_column(file, group + "/checksum", checksums_);
}

void RemainderColumn::append(idf::Data row) {
  largest_bytes_ = std::max(largest_bytes_, idf::encoded_size(row));
  rows_.push_back(std::move(row));
}

Status RemainderColumn::write(h5::File& file, const std::string& group) {
  // Reading one row unpacks its whole block, so blocks of large rows have few rows.
  const size_t block = std::clamp<size_t>(
      kRemainderBlockBytes / std::max<size_t>(largest_bytes_, 1), 1, kRemainderBlockRows);
  ENGRAM_RETURN_IF_ERROR(file.make_group(group));
  ENGRAM_RETURN_IF_ERROR(
      file.write_attribute(group, "rows_per_block", static_cast<int64_t>(block)));
  ENGRAM_ASSIGN_OR_RETURN(const auto blocks, take_blocks(block));
  const BlobColumn blobs =
      pack_blocks(blocks, [](auto plain) { return compress_zstd(plain, kRemainderLevel); });
  if (const auto dictionary = trained_dictionary(blocks, blobs.size_bytes())) {
    const uint64_t size = dictionary->bytes().size();
    const BlobColumn smaller =
        pack_blocks(blocks, [&](auto plain) { return dictionary->compress(plain); });
    if (smaller.size_bytes() + size + kDatasetBytes < blobs.size_bytes()) {
      ENGRAM_RETURN_IF_ERROR(file.write(group + "/dictionary", h5::Type::kUInt8, {&size, 1},
                                        dictionary->bytes().bytes(), h5::Storage::kCompressed));
      return smaller.write(file, group);
    }
  }
  return blobs.write(file, group);
}

Result<std::vector<Buffer>> RemainderColumn::take_blocks(size_t rows_per_block) {
  std::vector<Buffer> blocks;
  for (size_t first = 0; first < rows_.size(); first += rows_per_block) {
    const size_t end = std::min(first + rows_per_block, rows_.size());
    idf::List rows;
    for (size_t i = first; i < end; ++i) rows.push_back(std::move(rows_[i]));
    ENGRAM_ASSIGN_OR_RETURN(auto plain,
                            idf::encode(std::move(rows), idf::kMaxDepth + idf::kContainerDepth));
    blocks.push_back(Buffer::take(std::move(plain)));
  }
  rows_.clear();
  return blocks;
}

}  // namespace engram::ltm
