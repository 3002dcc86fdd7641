// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "ltm/idf/data.h"
#include "ltm/idf/type.h"
#include "ltm/memory/action_outcome.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// What a value tells that may be worth remembering, whatever its type.
struct ToldEvents {
  ActionOutcome outcome = ActionOutcome::kUnknown;
  bool is_speech = false;
  uint64_t links = 0;  ///< A hash of the entities that it leads to; 0 without links.
};

/// Reads a value. Arrays are not looked at, and nothing below 64 levels.
/// Complexity: O(size of the value without arrays).
[[nodiscard]] ToldEvents told_events(const idf::Data& value, const std::optional<idf::Type>& type);

/// The outcome that a member named outcome, status, result, success or succeeded tells.
[[nodiscard]] ActionOutcome outcome_in(const idf::Data& value,
                                       const std::optional<idf::Type>& type);

/// Whether a text in this member is speech: without a name, or named text, words, utterance,
/// transcript or sentence.
[[nodiscard]] bool is_speech_member(std::string_view path);

/// The entity that a text leads to; nothing if it is no link.
[[nodiscard]] std::optional<MemoryId> linked_entity(const std::string& text);

/// Mixes a text into a hash. The order of calls counts.
[[nodiscard]] uint64_t mixed_text(uint64_t before, std::string_view text);

}  // namespace engram::ltm
