// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/file_window.h"

#include <algorithm>

namespace engram::datasets {

namespace {
constexpr uint64_t kWindowBytes = 1 << 16;
}  // namespace

Result<FileWindow> FileWindow::open(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(File file, File::open(path, File::Mode::kRead));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  return FileWindow(std::move(file), size);
}

Result<std::span<const std::byte>> FileWindow::read(uint64_t offset, uint64_t count) {
  ENGRAM_CHECK(offset <= size_ && count <= size_ - offset, "{} bytes at {} of {}", count, offset,
               size_);
  if (offset < begin_ || offset + count > begin_ + bytes_.size()) {
    bytes_.resize(std::min(std::max(count, kWindowBytes), size_ - offset));
    begin_ = offset;
    if (const Status status = file_.read_at(offset, bytes_); !status.ok()) {
      bytes_.clear();
      return status;
    }
  }
  return std::span<const std::byte>(bytes_).subspan(offset - begin_, count);
}

}  // namespace engram::datasets
