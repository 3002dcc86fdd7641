// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/work_progress.h"

#include <algorithm>

namespace engram::datasets::vault {

namespace {

/// Telling costs more than a small snapshot.
constexpr uint64_t kStepsPerTelling = 64;

}  // namespace

void WorkProgress::begin(uint64_t total) {
  total_ = total;
  done_ = told_ = 0;
  begin_ = steady_now();
}

void WorkProgress::add(uint64_t done, const std::string& detail) {
  done_ += done;
  if (done_ - told_ < std::min(kStepsPerTelling, 1 + total_ / kStepsPerTelling)) return;
  told_ = done_;
  tell(detail);
}

void WorkProgress::end() {
  total_ = done_ = std::max(total_, done_);
  if (total_ > 0) tell("");
}

void WorkProgress::tell(const std::string& detail) const {
  if (!sink_) return;
  const double took = std::chrono::duration<double>(steady_now() - begin_).count();
  const uint64_t total = std::max(total_, done_);
  const double left = static_cast<double>(total - done_);
  sink_({.what = what_,
         .done = done_,
         .total = total,
         .detail = detail,
         .seconds_left = done_ == 0 ? -1 : took / static_cast<double>(done_) * left});
}

}  // namespace engram::datasets::vault
