// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/number_blocks.h"

#include <algorithm>

#include "ltm/codec/column_codec.h"
#include "ltm/store/segment_blobs.h"

namespace engram::ltm {

namespace {

constexpr const char* kCodec = "columns";
/// Who reads one row decodes its block: wide ones have fewer rows.
constexpr size_t kBlockBytes = 256 << 10;
constexpr uint64_t kLeastRows = 64;
constexpr uint64_t kMostRows = 4096;
/// A hostile file may tell of any size.
constexpr uint64_t kMostBlockBytes = uint64_t{1} << 30;

/// Swaps cells and their elements: `[rows, count]` to `[count, rows]`.
void transpose(std::span<const std::byte> from, size_t rows, size_t count, size_t width,
               std::span<std::byte> to) {
  for (size_t row = 0; row < rows; ++row)
    for (size_t i = 0; i < count; ++i)
      std::copy_n(from.data() + (row * count + i) * width, width,
                  to.data() + (i * rows + row) * width);
}

}  // namespace

Status write_number_blocks(h5::File& file, const std::string& group, const NumberTable& table,
                           std::span<const std::byte> cells) {
  const size_t width = idf::size_bytes(table.type);
  const size_t row_bytes = table.row_bytes();
  const uint64_t per_block =
      std::clamp<uint64_t>(kBlockBytes / std::max<size_t>(row_bytes, 1), kLeastRows, kMostRows);
  BlobColumn blobs;
  std::vector<std::byte> turned;
  for (uint64_t first = 0; first < table.rows; first += per_block) {
    const size_t rows = std::min(per_block, table.rows - first);
    turned.resize(rows * row_bytes);
    transpose(cells.subspan(first * row_bytes, turned.size()), rows, table.columns * table.elements,
              width, turned);
    const size_t column_bytes = rows * table.cell_bytes();
    for (size_t i = 0; i < table.columns; ++i)
      blobs.append(compress_column(
          table.type, std::span<const std::byte>(turned).subspan(i * column_bytes, column_bytes)));
  }
  ENGRAM_RETURN_IF_ERROR(blobs.write(file, group));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "codec", kCodec));
  return file.write_attribute(group, "rows_per_block", static_cast<int64_t>(per_block));
}

Result<bool> NumberBlocks::has(const std::string& group) {
  ENGRAM_ASSIGN_OR_RETURN(const Block* block, find(group));
  return block->is_there;
}

Result<std::span<const std::byte>> NumberBlocks::row(const std::string& group,
                                                     const NumberTable& table, uint64_t row) {
  ENGRAM_ASSIGN_OR_RETURN(Block * block, find(group));
  if (row >= table.rows)
    return source_.broken(group, fmt::format("has {} rows, needs row {}", table.rows, row));
  const uint64_t number = row / block->rows_per_block;
  if (block->number != number) ENGRAM_RETURN_IF_ERROR(load(group, table, number, *block));
  const uint64_t at = row % block->rows_per_block * table.row_bytes();
  return std::span<const std::byte>(block->cells).subspan(at, table.row_bytes());
}

Result<NumberBlocks::Block*> NumberBlocks::find(const std::string& group) {
  if (const auto known = blocks_.find(group); known != blocks_.end()) return &known->second;
  Block block;
  ENGRAM_ASSIGN_OR_RETURN(block.is_there, source_.file().is_group(group));
  if (block.is_there) {
    const h5::File& file = source_.file();
    ENGRAM_ASSIGN_OR_RETURN(const std::string codec, file.string_attribute(group, "codec"));
    if (codec != kCodec)
      return source_.broken(group, fmt::format("has the unknown codec '{}'", codec));
    ENGRAM_ASSIGN_OR_RETURN(const int64_t rows, file.int_attribute(group, "rows_per_block"));
    if (rows < 1 || rows > int64_t{1} << 32)
      return source_.broken(group, fmt::format("has {} rows per block", rows));
    block.rows_per_block = static_cast<uint64_t>(rows);
  }
  return &blocks_.emplace(group, std::move(block)).first->second;
}

Status NumberBlocks::load(const std::string& group, const NumberTable& table, uint64_t number,
                          Block& block) {
  const uint64_t first = number * block.rows_per_block;
  const uint64_t rows = std::min(block.rows_per_block, table.rows - first);
  if (table.row_bytes() > kMostBlockBytes / rows)
    return source_.broken(group, fmt::format("has blocks of {} rows of {} bytes, at most {} bytes "
                                             "fit",
                                             rows, table.row_bytes(), kMostBlockBytes));
  std::vector<std::byte> turned;
  for (size_t i = 0; i < table.columns; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const Buffer packed, source_.blob(group, number * table.columns + i));
    ENGRAM_ASSIGN_OR_RETURN(
        const auto column,
        source_.located(decompress_column(packed.bytes(), table.type, rows * table.elements)));
    turned.insert(turned.end(), column.begin(), column.end());
  }
  block.number = UINT64_MAX;
  block.cells.resize(turned.size());
  transpose(turned, table.columns * table.elements, rows, idf::size_bytes(table.type), block.cells);
  block.number = number;
  return {};
}

}  // namespace engram::ltm
