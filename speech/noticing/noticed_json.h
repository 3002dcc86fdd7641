// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "speech/noticing/notice_deeds.h"

namespace engram::speech {

/// What was noticed, and of how many deeds something was committed: {"episodes", "snapshots",
/// "deeds", "committed"}. A deed has "hand", "thing", "place", "task", "episode", "took", "let_go"
/// (times; null: never), "open_before", "open_after" (in the unit of its joints) and "joints", the
/// snapshots that show it.
[[nodiscard]] nlohmann::ordered_json to_json(const Noticed& noticed, size_t committed);

/// "auto", "high" or "low".
/// Errors: kInvalidArgument.
Result<OpenHand> open_hand_named(std::string_view name);

}  // namespace engram::speech
