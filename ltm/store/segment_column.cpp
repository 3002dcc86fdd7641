// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_column.h"

#include <algorithm>

namespace engram::ltm {

namespace {

/// Window size of datasets that are not chunked, in bytes.
constexpr uint64_t kWindowBytes = 64 << 10;
/// Max number of windows kept per column, and their approximate max total size.
constexpr uint64_t kMaxWindows = 8;
constexpr uint64_t kKeptBytes = 256 << 10;

}  // namespace

Result<SegmentColumn> SegmentColumn::open(const h5::File& file, const std::string& path) {
  ENGRAM_ASSIGN_OR_RETURN(h5::DatasetInfo info, file.info(path));
  return SegmentColumn(file, path, std::move(info));
}

SegmentColumn::SegmentColumn(const h5::File& file, std::string path, h5::DatasetInfo info)
    : file_(&file), path_(std::move(path)), info_(std::move(info)) {
  const uint64_t count = std::max<uint64_t>(rows(), 1);
  row_bytes_ = info_.count() / count * h5::size_bytes(info_.type);
  const uint64_t bytes = std::max<uint64_t>(row_bytes_, 1);
  window_rows_ = std::clamp<uint64_t>(info_.chunk_rows.value_or(kWindowBytes / bytes), 1, count);
  max_windows_ = std::clamp<uint64_t>(kKeptBytes / bytes / window_rows_, 1, kMaxWindows);
}

Result<const SegmentColumn::Window*> SegmentColumn::window_of(uint64_t index) {
  const uint64_t first = index / window_rows_ * window_rows_;
  auto known = std::ranges::find(windows_, first, &Window::first);
  if (known == windows_.end()) {
    const uint64_t count = std::min(window_rows_, rows() - first);
    ENGRAM_ASSIGN_OR_RETURN(auto bytes, file_->read_rows(path_, info_.type, first, count));
    if (windows_.size() < max_windows_)
      known = windows_.insert(windows_.end(), Window{});
    else
      known = std::ranges::min_element(windows_, {}, &Window::last_use);
    *known = {first, 0, std::move(bytes)};
  }
  known->last_use = ++uses_;
  return &*known;
}

Result<std::span<const std::byte>> SegmentColumn::row(uint64_t index) {
  if (index >= rows()) return data_loss("'{}' has {} rows, needs row {}", path_, rows(), index);
  ENGRAM_ASSIGN_OR_RETURN(const Window* window, window_of(index));
  return std::span<const std::byte>(window->bytes)
      .subspan((index - window->first) * row_bytes_, row_bytes_);
}

}  // namespace engram::ltm
