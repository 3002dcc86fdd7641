// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: when questions are asked.

#include <vector>

#include "speech/dialogues/lived_past.h"

namespace engram::speech::dialogues {

/// Up to two moments while the last recording went on, the first of them one at which something was
/// held, if that ever was. Nothing begins, ends or is said shortly before and after them, and no
/// hand takes or lets go of anything.
///
/// Equal arguments give equal times.
[[nodiscard]] std::vector<Time> asking_times(const LivedPast& past, uint64_t seed);

}  // namespace engram::speech::dialogues
