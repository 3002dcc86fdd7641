// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "speech/attention/episode_groups.h"

namespace engram::speech {

/// What a network has read a question as.
struct AttendedProgram {
  Program program;
  /// 0..1: how likely the symbols are, times how surely the network attends to the very groups that
  /// the program is about.
  double confidence = 0;
};

/// The likeliest program that says all things, places and persons that the question names: one that
/// leaves one out would be about something else. The network says twice what it is about, by the
/// names of its filters and by the groups that it attends to; where the two differ, it is not sure.
///
/// Nothing: no reading makes such a program.
[[nodiscard]] std::optional<AttendedProgram> choose_program(const AttentionScores& scores,
                                                            const std::vector<EpisodeGroup>& groups,
                                                            const AskedNames& names,
                                                            const AskedTimes& times);

}  // namespace engram::speech
