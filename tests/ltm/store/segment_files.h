// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "ltm/store/segment_reader.h"
#include "ltm/store/segment_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {

/// What a segment is to hold.
using Entities = std::map<MemoryId, std::vector<Snapshot>>;

inline Result<SegmentInfo> write_entities(const std::filesystem::path& file,
                                          const Entities& entities) {
  std::map<MemoryId, RecordedEntity> packed;
  for (const auto& [id, snapshots] : entities)
    for (const Snapshot& snapshot : snapshots)
      packed[id].snapshots.push_back(pack_snapshot(snapshot));
  return write_recorded_segment(file, packed);
}

inline Result<std::vector<Snapshot>> read_entity(SegmentReader& reader, const MemoryId& entity) {
  std::vector<Snapshot> snapshots;
  ENGRAM_ASSIGN_OR_RETURN(const auto spans, reader.index(entity));
  for (const RowSpan& span : spans) {
    ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, reader.read_recorded(entity, span));
    ENGRAM_ASSIGN_OR_RETURN(Snapshot snapshot, unpack(packed));
    snapshots.push_back(std::move(snapshot));
  }
  return snapshots;
}

inline void expect_round_trip(const Entities& entities) {
  const ScratchDirectory scratch;
  const auto info = write_entities(scratch / "s.h5", entities);
  ASSERT_OK(info);
  EXPECT_EQ(info->bytes, std::filesystem::file_size(scratch / "s.h5"));
  uint64_t sum = 0;
  for (const SegmentEntity& part : info->entities) sum += part.stored_bytes;
  EXPECT_EQ(sum, info->entities.empty() ? 0 : info->bytes);
  const auto reader = SegmentReader::open(scratch / "s.h5");
  ASSERT_OK(reader);
  for (const auto& [id, snapshots] : entities) {
    const auto found = read_entity(**reader, id);
    ASSERT_OK(found);
    ASSERT_EQ(found->size(), snapshots.size());
    for (size_t i = 0; i < snapshots.size(); ++i) EXPECT_EQ((*found)[i], snapshots[i]) << i;
  }
}

}  // namespace engram::ltm
