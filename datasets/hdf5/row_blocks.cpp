// SPDX-License-Identifier: Apache-2.0
#include "datasets/hdf5/row_blocks.h"

#include <algorithm>

#include "ltm/core/utf8.h"

namespace engram::datasets {

namespace {

constexpr uint64_t kBlockBytes = 1 << 20;
constexpr uint64_t kMaxChunkBytes = 64 << 20;
constexpr uint64_t kTextRows = 256;
constexpr uint64_t kByteRows = 16;

uint64_t rows_of_block(const h5::ArrayInfo& info) {
  if (info.element.kind == h5::Kind::kBytes) return kByteRows;
  if (!info.element.is_number()) return kTextRows;
  const uint64_t row_bytes = std::max<uint64_t>(info.row_bytes(), 1);
  const uint64_t rows = std::max<uint64_t>(kBlockBytes / row_bytes, 1);
  const uint64_t chunk = info.chunk_rows;
  // Chunks that are too large are read again for each block, which is slow but bounds memory.
  if (chunk == 0 || chunk > kMaxChunkBytes / row_bytes) return rows;
  return std::max<uint64_t>(rows / chunk, 1) * chunk;
}

}  // namespace

RowBlocks::RowBlocks(std::string path, h5::ArrayInfo info, RowRole role)
    : path_(std::move(path)),
      info_(std::move(info)),
      role_(role),
      block_rows_(rows_of_block(info_)) {}

void RowBlocks::load(const h5::File& file, uint64_t row) {
  // If a block is damaged, some of its chunks may be intact, so they are read one by one.
  const uint64_t min = std::max<uint64_t>(info_.chunk_rows, 1);
  is_damaged_ = !read(file, row, block_rows_);
  if (is_damaged_ && min < block_rows_) is_damaged_ = !read(file, row, min);
}

bool RowBlocks::read(const h5::File& file, uint64_t row, uint64_t rows) {
  first_ = row / rows * rows;
  end_ = std::min(first_ + rows, info_.rows());
  if (info_.element.is_number()) {
    auto bytes = file.read_array_rows(path_, first_, end_ - first_);
    if (bytes.ok()) bytes_ = *std::move(bytes);
    return bytes.ok();
  }
  auto texts = file.read_array_texts(path_, first_, end_ - first_);
  if (texts.ok()) texts_ = *std::move(texts);
  return texts.ok();
}

std::optional<idf::Data> RowBlocks::value(const h5::File& file, uint64_t row,
                                          ReadingReport& report) {
  if (row >= end_) load(file, row);
  const auto damaged = [&report] {
    ++report.damaged;
    return std::nullopt;
  };
  if (is_damaged_) return damaged();
  if (!info_.element.is_number() && role_ != RowRole::kCompressed) {
    const std::string& text = texts_[row - first_];
    if (!is_utf8(text)) return damaged();
    return idf::Dict{{"text", text}};
  }
  const auto bytes = info_.element.is_number()
                         ? std::span<const std::byte>(bytes_).subspan(
                               (row - first_) * info_.row_bytes(), info_.row_bytes())
                         : as_bytes(texts_[row - first_]);
  if (role_ != RowRole::kCompressed) return row_value(info_, role_, bytes);
  auto image = compressed_row_value(bytes);
  if (!image.ok()) return damaged();
  return *std::move(image);
}

}  // namespace engram::datasets
