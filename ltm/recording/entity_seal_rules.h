// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "ltm/recording/recorder.h"

namespace engram::ltm {

/// Returns the seal-time parts of the rules by entity; empty if there are none. `options` must be
/// valid.
[[nodiscard]] SealRulesOf seal_rules_of(const Recorder::Options& options);

}  // namespace engram::ltm
