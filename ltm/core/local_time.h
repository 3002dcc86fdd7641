// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ltm/core/time.h"

namespace engram {

/// The next moment after `now` that a clock on the wall shows as `text`: "06:00" (today or
/// tomorrow), "2026-03-01 06:00" with or without seconds, in local time; or a moment with a zone
/// ("2026-03-01T06:00Z", "...+01:00").
/// Errors: kInvalidArgument naming the text and what was needed, also where the moment is not after
/// `now`.
/// Threading: not beside a change of the environment's TZ.
Result<Time> next_local_time(std::string_view text, Time now);

/// "2026-03-01 06:00:00", local time.
[[nodiscard]] std::string to_local_string(Time time);

}  // namespace engram
