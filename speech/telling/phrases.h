// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "speech/facts/known_world.h"
#include "speech/facts/records.h"

namespace engram::speech {

/// "salt", "salt and tea", "salt, tea and cup".
[[nodiscard]] std::string joined(const std::vector<std::string>& parts);

/// "my right hand", "my left and right hands"; what is called gripper is "my gripper".
[[nodiscard]] std::string my_hands(const std::vector<std::string>& hands);

/// "the salt", and "Ada" as it is.
[[nodiscard]] std::string with_article(const std::string& name);

/// What the robot did, without an end: "picked up the salt from the counter with my right hand".
[[nodiscard]] std::string past_phrase(const Execution& execution, const KnownWorld& world);
/// "pick up the salt from the counter with my right hand".
[[nodiscard]] std::string base_phrase(const Execution& execution, const KnownWorld& world);
/// "picking up the salt from the counter with my right hand".
[[nodiscard]] std::string gerund_phrase(const Execution& execution, const KnownWorld& world);
/// The same of a step that was planned: "place the salt on the table".
[[nodiscard]] std::string base_phrase(const PlannedStep& step, const KnownWorld& world);

/// What the robot did and how it ended, as a sentence without its full stop: "I tried to pick up
/// the salt, but failed: the hand closed 0.070 m away".
[[nodiscard]] std::string outcome_phrase(const Execution& execution, const KnownWorld& world);

/// What somebody said: `Ada said: "Bring me the salt."`
[[nodiscard]] std::string words_phrase(const SpokenWords& words);

/// "1 action", "3 actions".
[[nodiscard]] std::string counted(size_t count, std::string_view word);

/// A sentence: its first letter is a capital, and it ends with a full stop.
[[nodiscard]] std::string sentence(std::string text);

}  // namespace engram::speech
