// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/publish_recorded.h"

#include "ltm/core/file.h"
#include "ltm/store/temporary_file.h"

namespace engram::ltm {

Status publish_recorded(const std::filesystem::path& store,
                        const std::map<MemoryId, RecordedEntity>& entities,
                        const SegmentTypes& types) {
  ENGRAM_ASSIGN_OR_RETURN(const TemporaryFile file, TemporaryFile::create(store, ".h5"));
  ENGRAM_ASSIGN_OR_RETURN(SegmentInfo segment,
                          write_recorded_segment(file.path(), entities, types));
  return edit_manifest(store, [&](Manifest& manifest) -> Status {
    segment.file = fmt::format("segments/{:06}.h5", manifest.next_segment++);
    ENGRAM_RETURN_IF_ERROR(publish_file(file.path(), store / segment.file));
    manifest.segments.push_back(std::move(segment));
    return {};
  });
}

}  // namespace engram::ltm
