// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/number_blocks.h"

#include <algorithm>

#include "ltm/codec/column_codec.h"
#include "ltm/store/segment_blobs.h"

namespace engram::ltm {

namespace {

constexpr const char* kCodec = "columns";
/// Desired plain size of a block. Reading one row decodes its whole block, so blocks of wide rows
/// have fewer rows.
constexpr uint64_t kBlockBytes = 256 << 10;
constexpr uint64_t kMaxRows = 4096;
/// Desired min number of rows per block, because columns of few rows hardly compress. It applies
/// only up to kLargeBlockBytes.
constexpr uint64_t kWishedRows = 64;
constexpr uint64_t kLargeBlockBytes = 16 << 20;
static_assert(kLargeBlockBytes <= kMaxNumberBlockBytes);

/// Rows per block. If one row is not larger than kMaxNumberBlockBytes, the block is not larger
/// either.
uint64_t rows_per_block(uint64_t row_bytes) {
  row_bytes = std::max<uint64_t>(row_bytes, 1);
  const uint64_t rows = std::clamp(kBlockBytes / row_bytes, kWishedRows, kMaxRows);
  return std::clamp<uint64_t>(kLargeBlockBytes / row_bytes, 1, rows);
}

/// Transposes `[rows, count]` to `[count, rows]`, because neighbouring values of one column
/// compress better than those of one row.
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
  if (row_bytes > kMaxNumberBlockBytes)
    return invalid_argument("columns '{}': a row has {} bytes, at most {} fit", group, row_bytes,
                            kMaxNumberBlockBytes);
  const uint64_t per_block = rows_per_block(row_bytes);
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
  block->last_use = ++uses_;
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
  if (table.row_bytes() > kMaxNumberBlockBytes / rows)
    return source_.broken(group, fmt::format("has blocks of {} rows of {} bytes, at most {} bytes "
                                             "fit",
                                             rows, table.row_bytes(), kMaxNumberBlockBytes));
  block.number = UINT64_MAX;
  block.cells = {};
  make_room(rows * table.row_bytes());
  std::vector<std::byte> turned;
  for (size_t i = 0; i < table.columns; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const Buffer packed, source_.blob(group, number * table.columns + i));
    ENGRAM_ASSIGN_OR_RETURN(
        const auto column,
        source_.located(decompress_column(packed.bytes(), table.type, rows * table.elements)));
    turned.insert(turned.end(), column.begin(), column.end());
  }
  block.cells.resize(turned.size());
  transpose(turned, table.columns * table.elements, rows, idf::size_bytes(table.type), block.cells);
  block.number = number;
  return {};
}

uint64_t NumberBlocks::held_bytes() const {
  uint64_t bytes = 0;
  for (const auto& [group, block] : blocks_) bytes += block.cells.size();
  return bytes;
}

/// Frees the least recently used blocks until `bytes` more fit.
void NumberBlocks::make_room(uint64_t bytes) {
  const auto last_use = [](const auto& each) {
    return each.second.cells.empty() ? UINT64_MAX : each.second.last_use;
  };
  for (uint64_t held = held_bytes(); held > 0 && held + bytes > kept_bytes_;) {
    Block& oldest = std::ranges::min_element(blocks_, {}, last_use)->second;
    held -= oldest.cells.size();
    oldest.number = UINT64_MAX;
    oldest.cells = {};
  }
}

}  // namespace engram::ltm
