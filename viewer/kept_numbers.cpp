// SPDX-License-Identifier: Apache-2.0
#include "viewer/kept_numbers.h"

namespace engram::viewer {

std::vector<std::shared_ptr<NumberColumn>> KeptNumbers::columns(
    size_t instance, const std::vector<std::string>& paths) {
  const size_t count = times_->all.size();
  size_t stride = 1;
  while (stride < count && (count / stride + 1) * sizeof(float) * paths.size() > max_bytes_)
    stride *= 2;
  const size_t column_bytes = (count + stride - 1) / stride * sizeof(float);
  const MutexLock lock(mutex_);
  size_t missing = 0;
  for (const std::string& path : paths)
    if (!columns_.contains({stride, instance, path})) missing += column_bytes;
  if (bytes_ + missing > max_bytes_) {
    columns_.clear();
    bytes_ = 0;
  }
  std::vector<std::shared_ptr<NumberColumn>> found;
  for (const std::string& path : paths) {
    auto& column = columns_[{stride, instance, path}];
    if (column == nullptr) {
      column = std::make_shared<NumberColumn>(count, stride);
      bytes_ += column_bytes;
    }
    found.push_back(column);
  }
  return found;
}

}  // namespace engram::viewer
