// SPDX-License-Identifier: Apache-2.0
#include "training/fit/thinning.h"

#include <algorithm>
#include <cmath>

#include "training/fit/windows.h"

namespace engram::training {

namespace {

/// Number of snapshots that stay together, because windows need neighbours.
constexpr size_t kRunLength = 32;

/// Adds the parts of some snapshots.
void cut(const Sequence& rows, std::vector<Sequence>& parts) {
  for (size_t i = rows.first; i < rows.end; i += kRunLength)
    parts.push_back({i, std::min(i + kRunLength, rows.end)});
}

/// Parts, evenly spaced, with at most `share` of the snapshots; at least a share of the first part.
std::vector<Sequence> chosen(const std::vector<Sequence>& parts, double share) {
  std::vector<Sequence> kept;
  double due = 0;
  for (const Sequence& part : parts) {
    const auto size = static_cast<double>(part.size());
    due += size * share;
    if (due < size) continue;
    due -= size;
    kept.push_back(part);
  }
  if (!kept.empty() || parts.empty()) return kept;
  const auto first = parts.front();
  const auto rows = static_cast<size_t>(std::ceil(share * static_cast<double>(first.size())));
  // A window needs a snapshot before and one after.
  constexpr size_t kWindow = 3;
  return {{first.first, first.first + std::min(std::max(rows, kWindow), first.size())}};
}

}  // namespace

ThinnedRuns thinned(const std::vector<Sequence>& recordings, size_t max_rows) {
  size_t total = 0;
  for (const Sequence& recording : recordings) total += recording.size();
  std::vector<SnapshotRun> runs;
  if (total <= max_rows) {
    for (const Sequence& recording : recordings)
      runs.push_back({recording, held_out_from(recording)});
    return {std::move(runs), {}};
  }
  std::vector<Sequence> training, held_out;
  for (const Sequence& recording : recordings) {
    const size_t limit = held_out_from(recording);
    cut({recording.first, limit}, training);
    cut({limit, recording.end}, held_out);
  }
  const double share = static_cast<double>(max_rows) / static_cast<double>(total);
  const std::vector<Sequence> trained = chosen(training, share);
  for (const Sequence& part : trained) runs.push_back({part, part.end});
  for (const Sequence& part : chosen(held_out, share)) runs.push_back({part, part.first});
  std::ranges::sort(runs, {}, [](const SnapshotRun& run) { return run.rows.first; });
  std::erase_if(training, [&](const Sequence& part) {
    return std::ranges::binary_search(trained, part.first, {}, &Sequence::first);
  });
  return {std::move(runs), std::move(training)};
}

}  // namespace engram::training
