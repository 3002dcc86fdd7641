// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/store_times.h"

#include <algorithm>

namespace engram::ltm {

namespace {

/// Each has a file open, and windows of the columns that were read last.
constexpr size_t kMaxOpenForTimes = 16;

}  // namespace

StoreTimes::StoreTimes(StoreReader& reader) : reader_(reader), index_(reader.manifest().segments) {}

Result<SegmentReader*> StoreTimes::open(uint32_t segment) {
  const auto known = std::ranges::find(open_, segment, &decltype(open_)::value_type::first);
  if (known != open_.end()) {
    open_.splice(open_.begin(), open_, known);
    return open_.front().second.get();
  }
  const std::string& file = reader_.manifest().segments[segment].file;
  auto opened = SegmentReader::open(reader_.path() / file);
  if (opened.status().code() == StatusCode::kNotFound) {
    // A later generation may have removed it while this one was read.
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t now, read_generation(reader_.path()));
    if (now != reader_.manifest().generation)
      return unavailable("store '{}': segment '{}' was replaced meanwhile: open the store again",
                         reader_.path().string(), file);
    return data_loss("store '{}': segment '{}' is missing", reader_.path().string(), file);
  }
  if (!opened.ok()) return opened.status();
  open_.emplace_front(segment, std::move(opened).value());
  if (open_.size() > kMaxOpenForTimes) open_.pop_back();
  return open_.front().second.get();
}

Result<EntityTimes> StoreTimes::of(const MemoryId& entity) {
  // It names the entities that there are where there is no such one.
  if (!reader_.has(entity)) return reader_.timeline(entity).status();
  EntityTimes times;
  for (const auto& [segment, part] : index_.of(entity)) {
    if (part->snapshots == 0) continue;
    ENGRAM_ASSIGN_OR_RETURN(SegmentReader * open_segment, open(segment));
    ENGRAM_ASSIGN_OR_RETURN(const auto spans, open_segment->index(entity));
    std::vector<Time> some(spans.size());
    std::ranges::transform(spans, some.begin(), &RowSpan::time);
    times.add(some, reader_.manifest().segments[segment].kind == SegmentKind::kLatent,
              part->augmented == part->snapshots);
  }
  const std::vector<SnapshotEntry> unsealed = reader_.unsealed(entity);
  std::vector<Time> some(unsealed.size());
  std::ranges::transform(unsealed, some.begin(), &SnapshotEntry::time);
  times.add(some, false, false);
  return times;
}

}  // namespace engram::ltm
