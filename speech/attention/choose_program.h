// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "speech/attention/episode_groups.h"

namespace engram::speech {

/// What a network has read a question as.
struct AttendedProgram {
  Program program;
  /// 0..1: how likely the symbols are, times how surely the groups are told apart that the program
  /// selects.
  double confidence = 0;
};

/// The program whose filters select what the network attends to. The network says which groups it
/// selects, and no filters; those are looked for among what the question names, and have to have
/// all names of it: an answer that leaves one out would be about something else. Where several
/// programs select the same, the shortest is taken.
///
/// Nothing: no reading makes a program that validates and says all names.
[[nodiscard]] std::optional<AttendedProgram> choose_program(const AttentionScores& scores,
                                                            const std::vector<EpisodeGroup>& groups,
                                                            const AskedNames& names,
                                                            const AskedTimes& times);

}  // namespace engram::speech
