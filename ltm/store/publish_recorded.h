// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>

#include "ltm/store/segment_writer.h"

namespace engram::ltm {

/// Publishes packed snapshots as a segment of their own, as they are: groups of images stay groups,
/// which a journal could not hold. Needs snapshots at times at which the store has none: those of a
/// journal would come before them.
///
/// The caller holds the store's writer (StoreWriter), whose journals are sealed.
/// Errors: those of write_recorded_segment and edit_manifest; the store then is as before.
Status publish_recorded(const std::filesystem::path& store,
                        const std::map<MemoryId, RecordedEntity>& entities,
                        const SegmentTypes& types);

}  // namespace engram::ltm
