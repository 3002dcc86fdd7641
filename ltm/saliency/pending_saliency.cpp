// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/pending_saliency.h"

#include <algorithm>

#include "ltm/likeness/stored_codes.h"
#include "ltm/saliency/saliency_table.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

/// Both in the order of time. Of equal times those of `added` count.
EntitySaliency merged_rows(const EntitySaliency& old, const EntitySaliency& added) {
  EntitySaliency both{old.entity, {}, {}};
  size_t i = 0;
  for (size_t j = 0; j < added.times.size(); ++j) {
    for (; i < old.times.size() && old.times[i] < added.times[j]; ++i)
      both.append(old.times[i], old.rows[i]);
    if (i < old.times.size() && old.times[i] == added.times[j]) ++i;
    both.append(added.times[j], added.rows[j]);
  }
  for (; i < old.times.size(); ++i) both.append(old.times[i], old.rows[i]);
  return both;
}

void make_stale_rows(EntitySaliency& one) {
  for (SaliencyRow& row : one.rows) row = {{}, row.stands_for, RowState::kStale};
}

/// Gives the snapshots of an entity their rows. `entries` and the rows are in the order of time.
void restore_entity(const EntitySaliency& all, const std::vector<SnapshotEntry>& entries,
                    const std::set<uint32_t>& bare, PendingSaliency& pending) {
  size_t row = 0;
  for (size_t i = 0; i < entries.size(); ++i) {
    const SnapshotEntry& entry = entries[i];
    while (row < all.times.size() && all.times[row] < entry.time) ++row;
    if (row == all.times.size()) return;
    if (all.times[row] != entry.time) continue;
    const SaliencyRow& before = all.rows[row];
    SaliencyRow kept = before;
    const bool is_last = i + 1 == entries.size();
    for (++row; row < all.times.size() && (is_last || all.times[row] < entries[i + 1].time); ++row)
      kept.stands_for += std::min(all.rows[row].stands_for, UINT32_MAX - kept.stands_for);
    const auto segment = segment_of_code(entry);
    if (segment && (bare.contains(*segment) || kept != before))
      pending.add(all.entity, entry, kept);
  }
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
                          const SaliencyRow& row) {
  const auto segment = segment_of_code(entry);
  if (!segment) return;
  EntitySaliency& one = by_segment_[*segment][entity];
  one.entity = entity;
  one.append(entry.time, row);
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

Result<KeptSaliency> KeptSaliency::read(const std::filesystem::path& store) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
  KeptSaliency kept;
  kept.entities_ = all_saliency(*reader);
  return kept;
}

void KeptSaliency::make_stale(const std::set<MemoryId>& entities) {
  for (auto& [entity, one] : entities_)
    if (entities.contains(entity)) make_stale_rows(one);
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
    restore_entity(all, entries, bare, pending);
    if (pending.is_full()) ENGRAM_RETURN_IF_ERROR(pending.write());
  }
  return pending.write();
}

Status make_saliency_stale(const std::filesystem::path& store, const std::set<MemoryId>& entities) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
  const auto is_named = [&](const EntitySaliency& one) { return entities.contains(one.entity); };
  for (const SegmentInfo& segment : reader->manifest().segments) {
    if (std::ranges::none_of(saliency_of_segment(*reader, segment), is_named)) continue;
    // What is there is read again by the edit, because another job may have added to it meanwhile.
    const Status written =
        edit_segment_index(store, segment, kSaliencyIndex, [&](std::span<const std::byte> there) {
          SegmentSaliency all;
          if (auto known = unpack_saliency(there); known.ok()) all = *std::move(known);
          for (EntitySaliency& one : all)
            if (is_named(one)) make_stale_rows(one);
          return pack_saliency(all);
        });
    if (!written.ok() && written.code() != StatusCode::kNotFound) return written;
  }
  return {};
}

}  // namespace engram::ltm
