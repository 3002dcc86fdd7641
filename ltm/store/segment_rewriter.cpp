// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_rewriter.h"

#include <algorithm>
#include <set>

#include "ltm/core/file.h"
#include "ltm/store/publish.h"
#include "ltm/store/segment_index.h"
#include "ltm/store/segment_reader.h"
#include "ltm/store/segment_writer.h"

namespace engram::ltm {

namespace {

/// The content of recorded segments without replaced snapshots and those to be forgotten.
struct Merged {
  std::map<MemoryId, RecordedEntity> entities;
  std::map<MemoryId, ForgottenSums> gone;
  /// Plain bytes as reports count them, without forgotten snapshots.
  std::map<MemoryId, uint64_t> raw_bytes;
  /// At least one snapshot was left out because it was forgotten or replaced by an update.
  bool has_less = false;

  /// True if nothing remains to be stored or counted.
  [[nodiscard]] bool empty() const {
    return std::ranges::all_of(entities, [this](const auto& entity) {
      return entity.second.snapshots.empty() && entity.second.trailing_dropped == 0 &&
             raw_bytes.at(entity.first) == 0;
    });
  }
};

class Merger {
 public:
  Merger(StoreReader& reader, const FateOf& fate_of) : reader_(reader), fate_of_(fate_of) {}

  Status add(uint32_t segment) {
    for (const SegmentEntity& part : reader_.manifest().segments[segment].entities) {
      RecordedEntity& kept = merged_.entities[part.id];
      kept.trailing_dropped += part.dropped;
      kept.trailing_dropped_bytes += part.dropped_bytes;
      merged_.raw_bytes[part.id] += part.raw_bytes;
      if (part.snapshots == 0) continue;
      ENGRAM_RETURN_IF_ERROR(keep_forms(segment, part.id, kept));
      ENGRAM_RETURN_IF_ERROR(add_snapshots(segment, part, kept));
    }
    return {};
  }

  Merged finish() {
    for (auto& [id, entity] : merged_.entities)
      std::ranges::stable_sort(entity.snapshots, {}, &PackedSnapshot::time);
    // Entities without remaining snapshots need no group.
    for (auto entity = merged_.entities.begin(); entity != merged_.entities.end();)
      entity = entity->second.snapshots.empty() && merged_.gone.contains(entity->first)
                   ? forget_rest(entity)
                   : std::next(entity);
    return std::move(merged_);
  }

 private:
  using Entities = std::map<MemoryId, RecordedEntity>;

  /// Numbers keep their stored form. Images keep theirs too, which needs no rules.
  Status keep_forms(uint32_t segment, const MemoryId& id, RecordedEntity& kept) {
    ENGRAM_ASSIGN_OR_RETURN(const StoredForms forms, reader_.forms(id, segment));
    columns_[id].insert(forms.columns.begin(), forms.columns.end());
    kept.rules = SealRules::columns(columns_[id]);
    return {};
  }

  Status add_snapshots(uint32_t segment, const SegmentEntity& part, RecordedEntity& kept) {
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, reader_.timeline(part.id));
    const size_t before = kept.snapshots.size();
    ENGRAM_RETURN_IF_ERROR(
        timeline->for_each(part.first, part.last, [&](const SnapshotEntry& entry) -> Status {
          const auto& recorded = entry.recorded;
          if (!recorded || recorded->rows == 0 || recorded->source != segment) return {};
          return add_snapshot(part.id, entry, kept);
        }));
    merged_.has_less = merged_.has_less || kept.snapshots.size() - before < part.snapshots;
    return {};
  }

  Status add_snapshot(const MemoryId& id, const SnapshotEntry& entry, RecordedEntity& kept) {
    const Fate fate = fate_of_(id, entry);
    if (fate == Fate::kDrop) return {};
    ENGRAM_ASSIGN_OR_RETURN(PackedSnapshot packed, reader_.read_packed(id, entry));
    if (fate == Fate::kForget) {
      note_gone(id, packed);
      return {};
    }
    kept.trailing_dropped -= packed.dropped;
    kept.trailing_dropped_bytes -= packed.dropped_bytes;
    kept.snapshots.push_back(std::move(packed));
    return {};
  }

  void note_gone(const MemoryId& id, const PackedSnapshot& packed) {
    ForgottenSums& sums = merged_.gone[id];
    ++sums.snapshots;
    sums.raw_bytes += packed.raw_bytes;
    merged_.raw_bytes[id] -= std::min(merged_.raw_bytes[id], packed.raw_bytes);
  }

  Entities::iterator forget_rest(Entities::iterator entity) {
    ForgottenSums& sums = merged_.gone[entity->first];
    sums.dropped += entity->second.trailing_dropped;
    sums.dropped_bytes += entity->second.trailing_dropped_bytes;
    return merged_.entities.erase(entity);
  }

  StoreReader& reader_;
  const FateOf& fate_of_;
  /// Compressed columns in any of the segments.
  std::map<MemoryId, std::set<std::string, std::less<>>> columns_;
  Merged merged_;
};

/// Writes the merged segment. `like` is one of the segments that it replaces.
Result<SegmentInfo> write_merged(const std::filesystem::path& file, const Merged& merged,
                                 const std::filesystem::path& like) {
  ENGRAM_ASSIGN_OR_RETURN(const auto source, SegmentReader::open(like));
  ENGRAM_ASSIGN_OR_RETURN(const SegmentTypes types, source->types());
  ENGRAM_ASSIGN_OR_RETURN(SegmentInfo made, write_recorded_segment(file, merged.entities, types));
  // Dropped recorded forms are still counted, because their latents remain.
  for (SegmentEntity& part : made.entities.edit()) part.raw_bytes = merged.raw_bytes.at(part.id);
  return made;
}

}  // namespace

Status replace_segments(const std::filesystem::path& store, const std::vector<SegmentInfo>& old,
                        const std::optional<MadeSegment>& made,
                        const std::function<void(Manifest&)>& note) {
  std::vector<std::string> obsolete;
  ENGRAM_RETURN_IF_ERROR(edit_manifest(store, [&](Manifest& manifest) -> Status {
    auto place = manifest.segments.end();
    for (const SegmentInfo& segment : old) {
      place = std::ranges::find(manifest.segments, segment.file, &SegmentInfo::file);
      if (place == manifest.segments.end())
        return failed_precondition("store '{}': segment '{}' went while it was rewritten",
                                   store.string(), segment.file);
      obsolete.push_back(segment.file);
    }
    if (made) {
      *place = made->info;
      place->file = fmt::format("segments/{:06}.h5", manifest.next_segment++);
      ENGRAM_RETURN_IF_ERROR(publish_file(made->file.path(), store / place->file));
    }
    std::erase_if(manifest.segments, [&](const SegmentInfo& segment) {
      return std::ranges::find(obsolete, segment.file) != obsolete.end();
    });
    note(manifest);
    obsolete = remove_unused_models(manifest, std::move(obsolete));
    return {};
  }));
  return remove_published(store, obsolete);
}

void add_sums(Manifest& manifest, const std::map<MemoryId, ForgottenSums>& gone) {
  for (const auto& [entity, sums] : gone) {
    ForgottenSums& total = manifest.forgotten[entity];
    total.snapshots += sums.snapshots;
    total.raw_bytes += sums.raw_bytes;
    total.dropped += sums.dropped;
    total.dropped_bytes += sums.dropped_bytes;
  }
}

Status SegmentRewriter::rewrite(const std::vector<uint32_t>& numbers, RewriteReport& report) {
  Merger merger(reader_, fate_of_);
  std::vector<SegmentInfo> old;
  for (const uint32_t number : numbers) {
    ENGRAM_RETURN_IF_ERROR(merger.add(number));
    old.push_back(reader_.manifest().segments[number]);
  }
  const Merged merged = merger.finish();
  if (numbers.size() == 1 && !merged.has_less) return {};
  std::optional<MadeSegment> made;
  if (!merged.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(TemporaryFile file, TemporaryFile::create(store_, ".h5"));
    ENGRAM_ASSIGN_OR_RETURN(SegmentInfo info,
                            write_merged(file.path(), merged, store_ / old.back().file));
    for (const SegmentInfo& segment : old)
      info.last_journal = std::max(info.last_journal, segment.last_journal);
    made.emplace(MadeSegment{std::move(file), std::move(info)});
  }
  ENGRAM_RETURN_IF_ERROR(replace_segments(
      store_, old, made, [&](Manifest& manifest) { add_sums(manifest, merged.gone); }));
  for (const SegmentInfo& segment : old) report.bytes_before += segment.bytes;
  report.segments_before += old.size();
  report.segments_after += made ? 1 : 0;
  report.bytes_after += made ? made->info.bytes : 0;
  for (const auto& [entity, sums] : merged.gone) report.snapshots += sums.snapshots;
  return {};
}

}  // namespace engram::ltm
