// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace engram::speech {

/// What a task says in one sentence: "Pick up the yellow bottle on the table."
struct TaskWords {
  std::string skill;  ///< "pick"; the first word where no verb is known; empty: there is none.
  std::string thing;  ///< "yellow bottle"; empty: none is named.
  std::string place;  ///< "table"; empty: none is named.

  friend bool operator==(const TaskWords&, const TaskWords&) = default;
};

/// Reads the task of an episode as people write them for robots: a verb, what it is done with, and
/// where. Of several sentences or parts the first one counts.
[[nodiscard]] TaskWords task_words(std::string_view text);

/// The last word of a thing's name: "bottle" of "yellow bottle".
[[nodiscard]] std::string head_word(const std::string& thing);

/// A name for an entity: "yellow_bottle".
[[nodiscard]] std::string entity_name(const std::string& words);

}  // namespace engram::speech
