// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/data.h"
#include "ltm/memory/action_outcome.h"
#include "ltm/memory/memory_id.h"
#include "speech/facts/known_world.h"

namespace engram::speech {

// Members of values that anybody may have committed: what is missing, of another type or no number
// is none.

/// The text of a member; empty where there is none.
[[nodiscard]] std::string text_in(const idf::Data& value, std::string_view member);

/// Nothing where the member is no time, or one of before 1844 or after 2096.
[[nodiscard]] std::optional<Time> time_in(const idf::Data& value, std::string_view member);

/// An integer of either width, or a bool.
[[nodiscard]] std::optional<int64_t> integer_in(const idf::Data& value, std::string_view member);

/// The ID of an entity or deeper that a text names.
[[nodiscard]] std::optional<ltm::MemoryId> link_named(const std::string& text);
[[nodiscard]] std::optional<ltm::MemoryId> link_in(const idf::Data& value, std::string_view member);

/// All links of a member that is a link or a list of links.
[[nodiscard]] std::vector<ltm::MemoryId> links_in(const idf::Data& value, std::string_view member);

/// `count` finite numbers of a member that is an array of floats.
[[nodiscard]] std::optional<std::vector<double>> numbers_in(const idf::Data& value,
                                                            std::string_view member, size_t count);

/// The outcome that an execution tells: a number is that of skill::Outcome, a text is read.
[[nodiscard]] ltm::ActionOutcome outcome_member(const idf::Data& value);

/// Where the member of a value with this prefix says that something is: a pose, or x, y and
/// heading. Nothing where there is no such member of finite numbers.
[[nodiscard]] std::optional<Spot> spot_in(const idf::Data& value, std::string_view prefix);

}  // namespace engram::speech
