// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/store/store_reader.h"
#include "training/night/entity_work.h"

// Private to this room.

namespace engram::training {

/// Version of the model that made the latents of a snapshot; 0 if it has none.
[[nodiscard]] int version_of_latents(const EntityWork& work, const ltm::SnapshotEntry& entry);

}  // namespace engram::training
