// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/rewrite.h"

#include <algorithm>
#include <set>

#include "ltm/core/file.h"
#include "ltm/store/checksum.h"
#include "ltm/store/publish.h"
#include "ltm/store/segment_reader.h"
#include "ltm/store/segment_rewriter.h"
#include "ltm/store/segment_writer.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

namespace {

/// Finds runs of recorded segments that can be joined. A latent segment ends a run, because a
/// recorded segment after it may update the snapshots from which the latents were made.
Result<std::vector<std::vector<uint32_t>>> runs_to_join(const std::filesystem::path& store,
                                                        const Manifest& manifest,
                                                        const CompactOptions& options) {
  std::vector<std::vector<uint32_t>> runs(1);
  uint64_t bytes = 0, snapshots = 0;
  SegmentTypes types;
  const auto end_run = [&] {
    if (!runs.back().empty()) runs.emplace_back();
    bytes = snapshots = 0;
  };
  for (uint32_t i = 0; i < manifest.segments.size(); ++i) {
    const SegmentInfo& segment = manifest.segments[i];
    if (segment.kind != SegmentKind::kRecorded) {
      end_run();
      continue;
    }
    uint64_t in_segment = 0;
    for (const SegmentEntity& entity : segment.entities) in_segment += entity.snapshots;
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, SegmentReader::open(store / segment.file));
    ENGRAM_ASSIGN_OR_RETURN(SegmentTypes own, reader->types());
    const bool has_room = bytes + segment.bytes <= options.segment_bytes &&
                          snapshots + in_segment <= options.segment_snapshots;
    if (!runs.back().empty() && (!has_room || !(own == types))) end_run();
    types = std::move(own);
    runs.back().push_back(i);
    bytes += segment.bytes;
    snapshots += in_segment;
  }
  std::erase_if(runs, [](const auto& run) { return run.size() < 2; });
  return runs;
}

/// Sums over the snapshots to be removed from latent segment `number` that have no other form.
Result<ForgottenSums> count_latent_only(StoreReader& reader, uint32_t number, const MemoryId& id,
                                        const std::vector<Time>& times) {
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, reader.timeline(id));
  ForgottenSums sums;
  for (const Time time : times) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(time));
    if (entry && entry->time == time && !entry->recorded && entry->latent->source == number)
      ++sums.snapshots;
  }
  return sums;
}

/// Rewrites a latent segment without the snapshots to be forgotten. Returns false if it contains
/// none of them.
Result<bool> rewrite_latents(const std::filesystem::path& store, StoreReader& reader,
                             uint32_t number, const ForgetSet& gone, RewriteReport& report) {
  const SegmentInfo& old = reader.manifest().segments[number];
  const SegmentEntity& part = old.entities.front();
  const auto forget = gone.find(part.id);
  if (forget == gone.end()) return false;
  ENGRAM_ASSIGN_OR_RETURN(const auto segment, SegmentReader::open(store / old.file));
  ENGRAM_ASSIGN_OR_RETURN(const auto spans, segment->index(part.id));
  std::vector<LatentSnapshot> kept;
  std::vector<Time> times;
  for (const RowSpan& span : spans) {
    if (forget->second.contains(span.time)) {
      times.push_back(span.time);
      continue;
    }
    ENGRAM_ASSIGN_OR_RETURN(LatentSnapshot snapshot, segment->read_latent(part.id, span));
    kept.push_back(std::move(snapshot));
  }
  if (kept.size() == spans.size()) return false;
  std::optional<MadeSegment> made;
  if (!kept.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(TemporaryFile file, TemporaryFile::create(store, ".h5"));
    ENGRAM_ASSIGN_OR_RETURN(SegmentInfo info, write_latent_segment(file.path(), part.id, kept));
    made.emplace(MadeSegment{std::move(file), std::move(info)});
  }
  ENGRAM_ASSIGN_OR_RETURN(const ForgottenSums sums,
                          count_latent_only(reader, number, part.id, times));
  ENGRAM_RETURN_IF_ERROR(replace_segments(store, {old}, made, [&](Manifest& manifest) {
    if (sums.snapshots > 0) add_sums(manifest, {{part.id, sums}});
  }));
  report.snapshots += sums.snapshots;
  report.bytes_before += old.bytes;
  report.bytes_after += made ? made->info.bytes : 0;
  ++report.segments_before;
  report.segments_after += made ? 1 : 0;
  return true;
}

/// Opens the store again for each segment to be rewritten, because a reader opened earlier does not
/// see replaced segments.
struct OpenedSegment {
  std::unique_ptr<StoreReader> reader;
  uint32_t number = 0;  ///< Index into the segments of the reader's manifest.
};

Result<OpenedSegment> open_for(const std::filesystem::path& store, const std::string& file) {
  OpenedSegment opened;
  ENGRAM_ASSIGN_OR_RETURN(opened.reader, StoreReader::open(store));
  const auto& segments = opened.reader->manifest().segments;
  const auto found = std::ranges::find(segments, file, &SegmentInfo::file);
  if (found == segments.end())
    return unavailable("store '{}': segment '{}' was replaced meanwhile: try again", store.string(),
                       file);
  opened.number = static_cast<uint32_t>(found - segments.begin());
  return opened;
}

bool holds_any(const SegmentInfo& segment, const ForgetSet& gone) {
  return std::ranges::any_of(gone, [&segment](const auto& entry) {
    const SegmentEntity* part = segment.find(entry.first);
    if (part == nullptr || part->snapshots == 0) return false;
    return entry.second.has_any_in(part->first, part->last);
  });
}

/// Fails if a model file of the entity differs from the published one.
Status check_models(const std::filesystem::path& store, const Manifest& manifest,
                    const MemoryId& entity) {
  for (const ModelInfo& model : manifest.models) {
    if (model.entity != entity) continue;
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t found, checksum_of_file(store / model.file));
    if (found != model.checksum)
      return data_loss("store '{}': model file '{}' fails its checksum; nothing was dropped",
                       store.string(), model.file);
  }
  return {};
}

bool is_dropped(const SnapshotEntry& entry, const TimeSet& keep) {
  return entry.recorded && entry.recorded->rows > 0 && entry.latent && !keep.contains(entry.time);
}

/// Counts dropped and kept snapshots, and reads the latents of the dropped ones first, because
/// their recorded form may be the only good copy.
Result<DropReport> check_before_drop(StoreReader& reader, const MemoryId& entity,
                                     const TimeSet& keep) {
  DropReport report;
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, reader.timeline(entity));
  ENGRAM_RETURN_IF_ERROR(timeline->for_each([&](const SnapshotEntry& entry) -> Status {
    if (!entry.recorded || entry.recorded->rows == 0) return {};
    const bool is_to_go = is_dropped(entry, keep);
    ++(is_to_go ? report.snapshots : report.kept);
    return is_to_go ? reader.read_latent(entity, entry).status() : Status();
  }));
  return report;
}

}  // namespace

Status CompactOptions::validate() const {
  if (segment_bytes == 0) return invalid_argument("segment_bytes: needs more than 0");
  if (segment_snapshots == 0) return invalid_argument("segment_snapshots: needs more than 0");
  return {};
}

Result<RewriteReport> compact(const std::filesystem::path& store, const CompactOptions& options,
                              const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  RewriteReport report;
  ENGRAM_ASSIGN_OR_RETURN(const Manifest manifest, read_manifest(store));
  ENGRAM_RETURN_IF_ERROR(manifest.verify_entities());
  ENGRAM_ASSIGN_OR_RETURN(const auto runs, runs_to_join(store, manifest, options));
  for (size_t i = 0; i < runs.size() && !report.is_cancelled; ++i) {
    if (progress) progress({"compact " + store.string(), i, runs.size(), "", -1});
    std::vector<std::string> files;
    for (const uint32_t number : runs[i]) files.push_back(manifest.segments[number].file);
    // Open the store again for each run: segment numbers change after each, and indices cost
    // memory.
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
    std::vector<uint32_t> numbers;
    for (uint32_t n = 0; n < reader->manifest().segments.size(); ++n)
      if (std::ranges::find(files, reader->manifest().segments[n].file) != files.end())
        numbers.push_back(n);
    SegmentRewriter rewriter(store, *reader, [](const auto&, const auto&) { return Fate::kKeep; });
    ENGRAM_RETURN_IF_ERROR(rewriter.rewrite(numbers, report));
    report.is_cancelled = stop.stop_requested();
  }
  return report;
}

Result<RewriteReport> forget_snapshots(const std::filesystem::path& store, const ForgetSet& gone,
                                       const ProgressSink& progress, const std::stop_token& stop) {
  RewriteReport report;
  ENGRAM_ASSIGN_OR_RETURN(const Manifest before, read_manifest(store));
  ENGRAM_RETURN_IF_ERROR(before.verify_entities());
  const FateOf fate_of = [&gone](const MemoryId& id, const SnapshotEntry& entry) {
    const auto times = gone.find(id);
    return times != gone.end() && times->second.contains(entry.time) ? Fate::kForget : Fate::kKeep;
  };
  // Remove latents first. If the process is killed in between, the recorded form is still complete;
  // in the other order, a forgotten snapshot would survive as latents.
  for (const SegmentKind kind : {SegmentKind::kLatent, SegmentKind::kRecorded}) {
    for (size_t i = 0; i < before.segments.size() && !report.is_cancelled; ++i) {
      const SegmentInfo& segment = before.segments[i];
      if (segment.kind != kind || !holds_any(segment, gone)) continue;
      if (progress) progress({"forget " + store.string(), i, before.segments.size(), "", -1});
      ENGRAM_ASSIGN_OR_RETURN(const OpenedSegment opened, open_for(store, segment.file));
      if (kind == SegmentKind::kLatent)
        ENGRAM_RETURN_IF_ERROR(
            rewrite_latents(store, *opened.reader, opened.number, gone, report).status());
      else
        ENGRAM_RETURN_IF_ERROR(
            SegmentRewriter(store, *opened.reader, fate_of).rewrite({opened.number}, report));
      report.is_cancelled = stop.stop_requested();
    }
  }
  return report;
}

Result<DropReport> drop_recorded(const std::filesystem::path& store, const MemoryId& entity,
                                 const TimeSet& keep) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
  ENGRAM_RETURN_IF_ERROR(reader->timeline(entity).status());
  ENGRAM_RETURN_IF_ERROR(check_models(store, reader->manifest(), entity));
  ENGRAM_ASSIGN_OR_RETURN(DropReport report, check_before_drop(*reader, entity, keep));
  if (report.snapshots == 0) return report;
  std::set<std::string> checked;
  for (const SegmentInfo& segment : reader->manifest().segments)
    if (segment.kind == SegmentKind::kLatent) checked.insert(segment.file);
  RewriteReport rewritten;
  // Rewrite in list order: older forms must be removed before the newer ones, whose place they
  // would otherwise take.
  for (const SegmentInfo& segment : reader->manifest().segments) {
    if (segment.kind != SegmentKind::kRecorded || segment.find(entity) == nullptr) continue;
    ENGRAM_ASSIGN_OR_RETURN(const OpenedSegment opened, open_for(store, segment.file));
    const auto& now = opened.reader->manifest().segments;
    const FateOf fate_of = [&](const MemoryId& id, const SnapshotEntry& entry) {
      // Latents that were published meanwhile were not read and checked.
      const bool is_to_go = id == entity && is_dropped(entry, keep) &&
                            checked.contains(now[entry.latent->source].file);
      return is_to_go ? Fate::kDrop : Fate::kKeep;
    };
    ENGRAM_RETURN_IF_ERROR(
        SegmentRewriter(store, *opened.reader, fate_of).rewrite({opened.number}, rewritten));
  }
  report.freed_bytes = rewritten.freed_bytes();
  return report;
}

}  // namespace engram::ltm
