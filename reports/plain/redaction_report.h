// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/forgetting/redact_store.h"

namespace engram::reports {

/// Prints what a redaction of a store did, or would do.
void print_redaction(const ltm::StoreRedaction& report, bool is_dry_run);

}  // namespace engram::reports
