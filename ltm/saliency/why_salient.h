// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>

#include "ltm/recall/access_table.h"
#include "ltm/recall/model.h"
#include "ltm/recall/store_past.h"
#include "ltm/saliency/salient_moment.h"

namespace engram::ltm {

/// Explains the saliency of the snapshot of an entity at `time`; without a time, of its last one.
///
/// What is kept is explained from the snapshot, the 34 before it and the more salient ones next to
/// it, which are read again. Where nothing is kept, all snapshots of the entity are looked at.
/// Errors: kNotFound if there is no such entity or snapshot; kFailedPrecondition if the snapshot
/// is damaged; kCancelled on `stop`; those of reading.
/// Source: docs/saliency.md.
Result<SalientMoment> why_salient(StorePast& past, const AccessTable& accesses,
                                  const MemoryId& entity, std::optional<Time> time,
                                  const std::stop_token& stop = {});

/// The same of a store as it is now.
Result<SalientMoment> why_salient(const std::filesystem::path& store, const ModelLoader& loader,
                                  const MemoryId& entity, std::optional<Time> time,
                                  const std::stop_token& stop = {});

}  // namespace engram::ltm
