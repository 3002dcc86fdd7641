// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_walk.h"

#include <algorithm>
#include <limits>

#include "ltm/store/checksum.h"
#include "ltm/store/segment_writer.h"

namespace engram::ltm {

namespace {

/// Max number of consecutive rows without a readable time that are searched for the next readable
/// one.
constexpr uint64_t kMaxUnreadableRows = uint64_t{1} << 18;

/// The rows from `row` on that share the readable time of `row`.
RowSpan snapshot_span(SegmentReader& reader, const MemoryId& entity, uint64_t row, uint64_t rows,
                      Time time) {
  RowSpan span{time, row, 1};
  while (row + span.rows < rows && span.rows < std::numeric_limits<uint32_t>::max()) {
    const auto next = reader.time_at(entity, row + span.rows);
    if (!next.ok() || *next != time) break;
    ++span.rows;
  }
  return span;
}

/// The rows from `row` on whose times cannot be read.
RowSpan unreadable_span(SegmentReader& reader, const MemoryId& entity, uint64_t row,
                        uint64_t rows) {
  uint64_t end = row + 1;
  while (end < rows && end - row < kMaxUnreadableRows && !reader.time_at(entity, end).ok()) ++end;
  // A hostile file may claim any number of rows, and trying each would take forever. The rest
  // counts as unreadable.
  if (end - row == kMaxUnreadableRows) end = rows;
  const uint64_t count = std::min<uint64_t>(end - row, std::numeric_limits<uint32_t>::max());
  return {Time{}, row, static_cast<uint32_t>(count)};
}

/// Reads the segment's entities one by one and sums up what can be read.
class Describer {
 public:
  Describer(SegmentReader& reader, DescribedSegment& result) : reader_(reader), result_(result) {}

  void add(const MemoryId& entity) {
    SegmentEntity part;
    part.id = entity;
    const Status status =
        walk_rows(reader_, entity, [&](const RowSpan& span, const Status& times) -> Status {
          if (!times.ok() || (part.snapshots > 0 && span.time < part.last) ||
              !read(part, span).ok())
            result_.is_whole = false;
          return {};
        });
    const auto stored = reader_.stored_bytes(entity);
    if (!status.ok() || !stored.ok()) result_.is_whole = false;
    part.stored_bytes = stored.value_or(0);
    result_.info.entities.edit().push_back(std::move(part));
  }

 private:
  Status read(SegmentEntity& part, const RowSpan& span) {
    ENGRAM_RETURN_IF_ERROR(result_.info.kind == SegmentKind::kLatent ? read_latent(part, span)
                                                                     : read_recorded(part, span));
    if (part.snapshots == 0) part.first = span.time;
    part.last = span.time;
    ++part.snapshots;
    part.rows += span.rows;
    return {};
  }

  Status read_recorded(SegmentEntity& part, const RowSpan& span) {
    ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, reader_.read_recorded(part.id, span));
    part.raw_bytes += packed.raw_bytes;
    part.augmented += packed.is_augmented() ? 1 : 0;
    part.dropped += packed.dropped;
    part.dropped_bytes += packed.dropped_bytes;
    return {};
  }

  Status read_latent(SegmentEntity& part, const RowSpan& span) {
    ENGRAM_ASSIGN_OR_RETURN(part.latent.model_version, reader_.model_version(part.id));
    ENGRAM_ASSIGN_OR_RETURN(const LatentSnapshot latent, reader_.read_latent(part.id, span));
    for (const LatentInstance& instance : latent.instances)
      add_to_sums(part.latent, instance.quality.error);
    return {};
  }

  SegmentReader& reader_;
  DescribedSegment& result_;
};

}  // namespace

Status walk_rows(SegmentReader& reader, const MemoryId& entity, const RowVisit& visit) {
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t rows, reader.row_count(entity));
  for (uint64_t row = 0; row < rows;) {
    const auto time = reader.time_at(entity, row);
    const RowSpan span = time.ok() ? snapshot_span(reader, entity, row, rows, *time)
                                   : unreadable_span(reader, entity, row, rows);
    ENGRAM_RETURN_IF_ERROR(visit(span, time.status()));
    row += span.rows;
  }
  return {};
}

Result<DescribedSegment> describe_segment(const std::filesystem::path& file) {
  DescribedSegment result;
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, SegmentReader::open(file));
  ENGRAM_ASSIGN_OR_RETURN(const SegmentContents contents, reader->contents());
  result.info.kind = contents.kind;
  result.damaged = contents.damaged;
  if (const auto types = reader->types(); !types.ok()) result.damaged.push_back(types.status());
  result.is_whole = result.damaged.empty();
  Describer describer(*reader, result);
  for (const MemoryId& entity : contents.entities) describer.add(entity);
  std::error_code error;
  result.info.bytes = std::filesystem::file_size(file, error);
  if (error) return unavailable("'{}': {}", file.string(), error.message());
  ENGRAM_ASSIGN_OR_RETURN(result.info.checksum, checksum_of_file(file));
  spread_overhead(result.info);
  return result;
}

}  // namespace engram::ltm
