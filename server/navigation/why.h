// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "memory/memory.h"

namespace engram::navigation {

/// One link of the answer to "why?".
struct WhyStep {
  ltm::MemoryId id;    ///< What is told of.
  std::string member;  ///< The member of the step before that leads here; empty for the first.
  std::string says;    ///< What its value says of itself, in a few words; empty: nothing.

  friend bool operator==(const WhyStep&, const WhyStep&) = default;
};

/// Why a snapshot is as it is, or the last one of an entity; told from links alone: from an event
/// of a drive to its plan, from there to the request, and on to what caused that, such as the words
/// of a person.
///
/// In each value the first of these members that is a link to a snapshot is followed: `plan`,
/// `request`, `cause`, `causes`, `command`, `task`, `trigger`; of a list its first such link. Where
/// a request leads nowhere, the `cause` beside the link to it is followed instead. It ends where
/// there is none, where a link leads to nothing that the memory has, and after 16 steps.
/// Errors: kNotFound where there is no such snapshot; those of Memory::query.
Result<std::vector<WhyStep>> why(Memory& memory, const ltm::MemoryId& id);

/// The answer in words, one line for each step.
[[nodiscard]] std::string why_text(const std::vector<WhyStep>& steps);

}  // namespace engram::navigation
