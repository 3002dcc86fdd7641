// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "ltm/likeness/similar.h"

namespace engram::reports {

/// Draws what was asked with and the moments that are like it, a row each, as a PNG. Columns: the
/// moment, and what was seen one and two seconds before it.
/// Errors: kFailedPrecondition if the entity has no images; those of reading; kUnavailable.
Status draw_similar(ltm::StorePast& past, const ltm::SimilarRequest& request,
                    const ltm::SimilarAnswer& answer, const std::filesystem::path& file);

}  // namespace engram::reports
