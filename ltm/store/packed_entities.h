// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: parts of the manifest.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/store/segment_entities.h"

namespace engram::ltm {

/// What a segment contains of many entities, as columns in a text of base64. Recorded segments
/// only. Errors: kInvalidArgument.
Result<std::string> pack_entities(std::span<const SegmentEntity> entities);

/// Reads what pack_entities wrote. Safe on hostile texts.
/// Errors: kDataLoss, kInvalidArgument.
/// Source: docs/format.md, section "Manifest".
Result<std::vector<SegmentEntity>> unpack_entities(std::string_view text);

}  // namespace engram::ltm
