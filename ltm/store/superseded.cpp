// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/superseded.h"

#include <optional>
#include <vector>

#include "ltm/store/segment_reader.h"
#include "ltm/store/segment_rewriter.h"
#include "ltm/store/segment_writer.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

namespace {

/// The rows of a segment that are the newest latents of their times.
struct NewestRows {
  std::vector<LatentSnapshot> snapshots;
  uint64_t superseded = 0;
};

Result<NewestRows> newest_rows(StoreReader& reader, SegmentReader& segment, uint32_t number,
                               const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, reader.timeline(entity));
  ENGRAM_ASSIGN_OR_RETURN(const auto spans, segment.index(entity));
  NewestRows rows;
  std::vector<RowSpan> newest;
  for (const RowSpan& span : spans) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(span.time));
    // Latents that a recorded form made obsolete are not replaced by latents, and stay.
    const bool is_superseded =
        entry && entry->time == span.time && entry->latent && entry->latent->source != number;
    if (is_superseded)
      ++rows.superseded;
    else
      newest.push_back(span);
  }
  if (rows.superseded == 0) return rows;
  for (const RowSpan& span : newest) {
    ENGRAM_ASSIGN_OR_RETURN(rows.snapshots.emplace_back(), segment.read_latent(entity, span));
  }
  return rows;
}

/// Rewrites one segment if it has superseded rows. Returns false if it has none.
Result<bool> rewrite_newest(const std::filesystem::path& store, StoreReader& reader,
                            uint32_t number, const MemoryId& entity, RewriteReport& report) {
  const SegmentInfo& old = reader.manifest().segments[number];
  ENGRAM_ASSIGN_OR_RETURN(const auto segment, SegmentReader::open(store / old.file));
  ENGRAM_ASSIGN_OR_RETURN(const NewestRows rows, newest_rows(reader, *segment, number, entity));
  if (rows.superseded == 0) return false;
  std::optional<MadeSegment> made;
  if (!rows.snapshots.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(TemporaryFile file, TemporaryFile::create(store, ".h5"));
    ENGRAM_ASSIGN_OR_RETURN(SegmentInfo info,
                            write_latent_segment(file.path(), entity, rows.snapshots));
    made.emplace(MadeSegment{std::move(file), std::move(info)});
  }
  ENGRAM_RETURN_IF_ERROR(replace_segments(store, {old}, made, [](Manifest&) {}));
  report.snapshots += rows.superseded;
  report.bytes_before += old.bytes;
  report.bytes_after += made ? made->info.bytes : 0;
  ++report.segments_before;
  report.segments_after += made ? 1 : 0;
  return true;
}

}  // namespace

Result<RewriteReport> remove_superseded_latents(const std::filesystem::path& store,
                                                const MemoryId& entity) {
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
                              rewrite_newest(store, *reader, number, entity, report));
      is_at_end = !is_rewritten;
    }
  }
  return report;
}

}  // namespace engram::ltm
