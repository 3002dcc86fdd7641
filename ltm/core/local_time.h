// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ltm/core/time.h"

namespace engram {

/// The next moment after `now` at which a wall clock shows `text`: "06:00" (today or tomorrow),
/// "2026-03-01 06:00" with or without seconds, in local time; or a moment with a zone
/// ("2026-03-01T06:00Z", "...+01:00").
/// Errors: kInvalidArgument naming the text and what was needed, also where the moment is not after
/// `now`.
/// Threading: must not run while the environment's TZ changes.
Result<Time> next_local_time(std::string_view text, Time now);

/// The local time as "2026-03-01 06:00:00".
[[nodiscard]] std::string to_local_string(Time time);

}  // namespace engram
