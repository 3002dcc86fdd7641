// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/night/consolidate_report.h"
#include "training/night/encode_entity.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::training {

/// A report with what the plan knows.
[[nodiscard]] EntityReport report_of(const PlannedEntity& planned);

/// Adds what was encoded. The rest of `wanted` snapshots waits for a later night.
void tell(const EncodedEntity& encoded, size_t wanted, EntityReport& report);

}  // namespace engram::training
