// SPDX-License-Identifier: Apache-2.0
#include "training/night/encoding_limits.h"

#include <algorithm>
#include <limits>

namespace engram::training {

namespace {

/// Share of the time that is left which is planned for: the next images may take longer.
constexpr double kPlanned = 0.8;
/// A shorter chain is better than none.
constexpr size_t kMinRows = 8;
/// Work that was begun may end so much later. The first may take longer than all others, because
/// nothing is known about how quality follows from crf.
constexpr Duration kGrace = std::chrono::seconds(5), kFirstGrace = std::chrono::seconds(15);

}  // namespace

size_t EncodingRate::fitting(size_t chain_rows) const {
  if (!limits_.end) return std::numeric_limits<size_t>::max();
  const double left = to_seconds(*limits_.end - pace_.now());
  if (left <= 0) return 0;
  const size_t min_rows = std::min(kMinRows, chain_rows);
  // Videos that are known from earlier nights take no time, and then others follow: what was
  // expected counts even if the last ones were quicker.
  const double each = std::max(last_, limits_.seconds_per_snapshot);
  if (each <= 0) return min_rows;
  const auto fitting = static_cast<size_t>(std::min(kPlanned * left / each, 1e9));
  const size_t step = fitting >= chain_rows ? chain_rows : min_rows;
  return std::max(fitting / step * step, snapshots_ == 0 ? min_rows : 0);
}

void EncodingRate::count(size_t snapshots, double seconds) {
  if (snapshots == 0) return;
  last_ = seconds / static_cast<double>(snapshots);
  snapshots_ += snapshots;
  seconds_ += seconds;
}

bool EncodingRate::is_over() const {
  return limits_.end && pace_.now() > *limits_.end + (snapshots_ == 0 ? kFirstGrace : kGrace);
}

double EncodingRate::seconds_for(size_t snapshots) const {
  const double each =
      snapshots_ > 0 ? seconds_ / static_cast<double>(snapshots_) : limits_.seconds_per_snapshot;
  return each > 0 ? each * static_cast<double>(snapshots) : -1;
}

}  // namespace engram::training
