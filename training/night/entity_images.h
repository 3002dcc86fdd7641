// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/idf/layout.h"
#include "ltm/idf/ndarray.h"
#include "ltm/store/store_reader.h"
#include "training/night/entity_work.h"

// Private to this room.

namespace engram::training {

/// Images by image member, one per snapshot.
using MemberImages = std::vector<std::vector<idf::NdArray>>;

/// Adds the images of a snapshot's first instance, one per image member of the layout.
/// Errors: kInvalidArgument if it has another layout; the errors of the store.
Status append_images(const EntityWork& work, const idf::Layout& layout,
                     const ltm::SnapshotEntry& entry, MemberImages& images);

}  // namespace engram::training
