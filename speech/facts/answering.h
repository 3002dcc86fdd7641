// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace engram::speech {

/// The skill with which a robot answers questions (speech/listening). It is none of the deeds that
/// the robot tells of: "What did you do last?" does not ask for the answer to itself.
inline constexpr const char* kAnsweringProvider = "speech";
inline constexpr const char* kAnsweringSkill = "answer";

}  // namespace engram::speech
