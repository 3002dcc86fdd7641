// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "ltm/likeness/similar_moments.h"
#include "ltm/memory/result.h"

namespace engram::reports {

/// The last snapshot of the entity at or before a time; nothing if there is none.
using SeenAt = std::function<Result<std::optional<ltm::SnapshotResult>>(Time time)>;

/// Draws what was asked with and the moments that are like it, a row each, as a PNG. Columns: the
/// moment, and what was seen one and two seconds before it.
/// Errors: kFailedPrecondition if the entity has no images; those of reading; kUnavailable.
Status draw_similar(const SeenAt& seen, const ltm::SimilarRequest& request,
                    const ltm::SimilarAnswer& answer, const std::filesystem::path& file);

}  // namespace engram::reports
