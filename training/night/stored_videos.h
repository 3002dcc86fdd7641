// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ltm/store/store_reader.h"
#include "training/forms/entity_videos.h"

// Private to this room.

namespace engram::encoders {
struct DeepModel;
}

namespace engram::training {

/// Adds the videos that the store holds of these values to `videos`, so that they are not searched
/// for again when another model codes the same snapshots. A video is found where a stored block
/// begins at the first of `entries` and its chains have the length of `model`'s.
///
/// What cannot be read is left out, because all of it can be made again.
void add_stored_videos(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                       std::span<const ltm::SnapshotEntry> entries,
                       std::span<const idf::Data> values, const encoders::DeepModel& model,
                       EntityVideos& videos);

}  // namespace engram::training
