// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/superseded.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "ltm/store/segment_reader.h"
#include "ltm/store/segment_rewriter.h"
#include "ltm/store/segment_writer.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

namespace {

/// The rows of a segment that stay.
struct StayingRows {
  std::vector<LatentSnapshot> snapshots;
  uint64_t removed = 0;
};

/// Whether latents stay in segment `number`.
using Stays = std::function<Result<bool>(const std::optional<SnapshotEntry>& entry, Time time,
                                         uint32_t number)>;

/// Latents that a recorded form made obsolete are not replaced by latents, and stay.
Result<bool> is_not_superseded(const std::optional<SnapshotEntry>& entry, Time time,
                               uint32_t number) {
  return !entry || entry->time != time || !entry->latent || entry->latent->source == number;
}

Result<StayingRows> staying_rows(StoreReader& reader, SegmentReader& segment, uint32_t number,
                                 const MemoryId& entity, const Stays& stays) {
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, reader.timeline(entity));
  ENGRAM_ASSIGN_OR_RETURN(const auto spans, segment.index(entity));
  StayingRows rows;
  std::vector<RowSpan> staying;
  for (const RowSpan& span : spans) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(span.time));
    ENGRAM_ASSIGN_OR_RETURN(const bool is_staying, stays(entry, span.time, number));
    if (is_staying)
      staying.push_back(span);
    else
      ++rows.removed;
  }
  if (rows.removed == 0) return rows;
  for (const RowSpan& span : staying) {
    ENGRAM_ASSIGN_OR_RETURN(rows.snapshots.emplace_back(), segment.read_latent(entity, span));
  }
  return rows;
}

/// Rewrites one segment if rows of it go. Returns false if none do.
Result<bool> rewrite_staying(const std::filesystem::path& store, StoreReader& reader,
                             uint32_t number, const MemoryId& entity, const Stays& stays,
                             RewriteReport& report) {
  const SegmentInfo& old = reader.manifest().segments[number];
  ENGRAM_ASSIGN_OR_RETURN(const auto segment, SegmentReader::open(store / old.file));
  ENGRAM_ASSIGN_OR_RETURN(const StayingRows rows,
                          staying_rows(reader, *segment, number, entity, stays));
  if (rows.removed == 0) return false;
  std::optional<MadeSegment> made;
  if (!rows.snapshots.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(TemporaryFile file, TemporaryFile::create(store, ".h5"));
    ENGRAM_ASSIGN_OR_RETURN(SegmentInfo info,
                            write_latent_segment(file.path(), entity, rows.snapshots));
    made.emplace(MadeSegment{std::move(file), std::move(info)});
  }
  ENGRAM_RETURN_IF_ERROR(replace_segments(store, {old}, made, [](Manifest&) {}));
  report.snapshots += rows.removed;
  report.bytes_before += old.bytes;
  report.bytes_after += made ? made->info.bytes : 0;
  ++report.segments_before;
  report.segments_after += made ? 1 : 0;
  return true;
}

Result<RewriteReport> keep_staying(const std::filesystem::path& store, const MemoryId& entity,
                                   const Stays& stays) {
  RewriteReport report;
  uint32_t done = 0;  // Segments of the entity that need nothing.
  for (bool is_at_end = false; !is_at_end;) {
    // A reader that was opened before a segment was replaced does not see the new one.
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
    ENGRAM_RETURN_IF_ERROR(reader->timeline(entity).status());
    is_at_end = true;
    const auto& segments = reader->manifest().segments;
    for (uint32_t number = done; number < segments.size() && is_at_end; ++number) {
      const bool is_of_entity =
          segments[number].kind == SegmentKind::kLatent && segments[number].find(entity) != nullptr;
      done = number;
      if (!is_of_entity) continue;
      ENGRAM_ASSIGN_OR_RETURN(const bool is_rewritten,
                              rewrite_staying(store, *reader, number, entity, stays, report));
      is_at_end = !is_rewritten;
    }
  }
  return report;
}

bool may_have_any(const SegmentInfo& segment, const ForgetSet& replaced) {
  return std::ranges::any_of(replaced, [&segment](const auto& one) {
    const SegmentEntity* part = segment.find(one.first);
    return part != nullptr && part->snapshots > 0 && one.second.has_any_in(part->first, part->last);
  });
}

}  // namespace

Result<RewriteReport> remove_superseded_recorded(const std::filesystem::path& store,
                                                 const ForgetSet& replaced,
                                                 const ProgressSink& progress,
                                                 const std::stop_token& stop) {
  RewriteReport report;
  ENGRAM_ASSIGN_OR_RETURN(const Manifest before, read_manifest(store));
  for (size_t i = 0; i < before.segments.size(); ++i) {
    const SegmentInfo& segment = before.segments[i];
    if (segment.kind != SegmentKind::kRecorded || !may_have_any(segment, replaced)) continue;
    if (stop.stop_requested()) return cancelled("rewriting segments was stopped");
    if (progress) progress({"rewrite " + store.string(), i, before.segments.size(), "", -1});
    // Opened again for each, since a reader does not see what was replaced after it was opened.
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
    const auto& now = reader->manifest().segments;
    const auto found = std::ranges::find(now, segment.file, &SegmentInfo::file);
    if (found == now.end())
      return unavailable("store '{}': segment '{}' was replaced meanwhile: try again",
                         store.string(), segment.file);
    SegmentRewriter rewriter(store, *reader, [](const auto&, const auto&) { return Fate::kKeep; });
    ENGRAM_RETURN_IF_ERROR(rewriter.rewrite({static_cast<uint32_t>(found - now.begin())}, report));
  }
  return report;
}

Result<RewriteReport> remove_superseded_latents(const std::filesystem::path& store,
                                                const MemoryId& entity) {
  return keep_staying(store, entity, is_not_superseded);
}

Result<RewriteReport> remove_latents(const std::filesystem::path& store, const MemoryId& entity,
                                     const TimeSet& unwanted) {
  const Stays stays = [&](const std::optional<SnapshotEntry>& entry, Time time,
                          uint32_t number) -> Result<bool> {
    const bool is_newest =
        entry && entry->time == time && entry->latent && entry->latent->source == number;
    if (!is_newest || !unwanted.contains(time)) return is_newest;
    if (!entry->recorded || entry->recorded->rows == 0)
      return failed_precondition("'{}': has no other form than its latents",
                                 entity.at(time).to_string());
    return false;
  };
  return keep_staying(store, entity, stays);
}

}  // namespace engram::ltm
