// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/pending_saliency.h"

#include <algorithm>

#include "ltm/likeness/stored_codes.h"
#include "ltm/saliency/saliency_table.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

void append_row(EntitySaliency& to, const EntitySaliency& from, size_t row) {
  to.times.push_back(from.times[row]);
  to.parts.push_back(from.parts[row]);
}

/// Both in the order of time. Of equal times those of `added` count.
EntitySaliency merged_rows(const EntitySaliency& old, const EntitySaliency& added) {
  EntitySaliency both{old.entity, {}, {}};
  size_t i = 0;
  for (size_t j = 0; j < added.times.size(); ++j) {
    for (; i < old.times.size() && old.times[i] < added.times[j]; ++i) append_row(both, old, i);
    if (i < old.times.size() && old.times[i] == added.times[j]) ++i;
    append_row(both, added, j);
  }
  for (; i < old.times.size(); ++i) append_row(both, old, i);
  return both;
}

}  // namespace

Result<std::vector<SnapshotEntry>> entries_of(StoreReader& store, const MemoryId& entity) {
  std::vector<SnapshotEntry> entries;
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store.timeline(entity));
  ENGRAM_RETURN_IF_ERROR(timeline->for_each([&entries](const SnapshotEntry& entry) {
    entries.push_back(entry);
    return Status();
  }));
  return entries;
}

void PendingSaliency::add(const MemoryId& entity, const SnapshotEntry& entry,
                          const StoredParts& parts) {
  const auto segment = segment_of_code(entry);
  if (!segment) return;
  EntitySaliency& one = by_segment_[*segment][entity];
  one.entity = entity;
  one.times.push_back(entry.time);
  one.parts.push_back(parts);
  ++count_;
}

Status PendingSaliency::write() {
  for (auto& [segment, entities] : by_segment_) {
    const Status stored = edit_segment_index(
        store_.path(), store_.manifest().segments[segment], kSaliencyIndex,
        [&entities](std::span<const std::byte> there) { return merged(there, entities); });
    // It was replaced meanwhile, and the next job looks at what replaced it.
    if (!stored.ok() && stored.code() != StatusCode::kNotFound) return stored;
  }
  by_segment_.clear();
  count_ = 0;
  return {};
}

std::vector<std::byte> PendingSaliency::merged(std::span<const std::byte> there,
                                               std::map<MemoryId, EntitySaliency>& entities) {
  SegmentSaliency all;
  if (auto known = unpack_saliency(there); known.ok()) all = *std::move(known);
  for (EntitySaliency& old : all) {
    const auto added = entities.find(old.entity);
    if (added == entities.end()) continue;
    old = merged_rows(old, added->second);
    entities.erase(added);
  }
  for (auto& [entity, one] : entities) all.push_back(std::move(one));
  return pack_saliency(all);
}

KeptSaliency KeptSaliency::read(StoreReader& store) {
  KeptSaliency kept;
  for (const SegmentInfo& segment : store.manifest().segments)
    for (EntitySaliency& one : saliency_of_segment(store, segment)) {
      EntitySaliency& all = kept.entities_[one.entity];
      all.entity = one.entity;
      all.times.insert(all.times.end(), one.times.begin(), one.times.end());
      all.parts.insert(all.parts.end(), one.parts.begin(), one.parts.end());
    }
  for (auto& [entity, all] : kept.entities_) sort_by_time(all);
  return kept;
}

Status KeptSaliency::restore(const std::filesystem::path& store) const {
  if (entities_.empty()) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
  const auto& segments = reader->manifest().segments;
  std::set<uint32_t> bare;
  for (uint32_t i = 0; i < segments.size(); ++i)
    if (!read_segment_index(store, segments[i], kSaliencyIndex).ok()) bare.insert(i);
  if (bare.empty()) return {};
  PendingSaliency pending(*reader);
  for (const auto& [entity, all] : entities_) {
    if (!reader->has(entity)) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto entries, entries_of(*reader, entity));
    size_t row = 0;
    for (const SnapshotEntry& entry : entries) {
      while (row < all.times.size() && all.times[row] < entry.time) ++row;
      if (row == all.times.size()) break;
      const auto segment = segment_of_code(entry);
      if (segment && bare.contains(*segment) && all.times[row] == entry.time)
        pending.add(entity, entry, all.parts[row]);
    }
    if (pending.is_full()) ENGRAM_RETURN_IF_ERROR(pending.write());
  }
  return pending.write();
}

Status remove_saliency_of(const std::filesystem::path& store, const std::set<MemoryId>& entities) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
  const auto is_erased = [&](const EntitySaliency& one) { return entities.contains(one.entity); };
  for (const SegmentInfo& segment : reader->manifest().segments) {
    SegmentSaliency left = saliency_of_segment(*reader, segment);
    if (std::erase_if(left, is_erased) == 0) continue;
    const Status written = edit_segment_index(
        store, segment, kSaliencyIndex,
        [&left](std::span<const std::byte> /*there*/) { return pack_saliency(left); });
    if (!written.ok() && written.code() != StatusCode::kNotFound) return written;
  }
  return {};
}

}  // namespace engram::ltm
