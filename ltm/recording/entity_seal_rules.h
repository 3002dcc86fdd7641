// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "ltm/recording/recorder.h"

namespace engram::ltm {

/// The seal-time parts of the rules, by entity; empty where there are none. `options` are valid.
[[nodiscard]] SealRulesOf seal_rules_of(const Recorder::Options& options);

}  // namespace engram::ltm
