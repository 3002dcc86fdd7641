// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "speech/attention/asked_names.h"
#include "speech/facts/known_facts.h"
#include "speech/program/program.h"

namespace engram::speech {

/// Records of a memory that are alike for a question: of one kind, skill and outcome, and with the
/// same of the things, places, hands and persons that it names. However much a memory has, there
/// are only so many kinds of episodes, and a network attends to these.
struct EpisodeGroup {
  ProgramSource source{};
  std::string skill;
  std::optional<ltm::ActionOutcome> outcome;  ///< Nothing: it is no execution.
  std::vector<bool> has_thing;                ///< For each thing that the question names.
  std::vector<bool> has_place;                ///< Of a thing: whether it is there.
  std::vector<bool> has_hand;                 ///< Of a thing: whether it is held by it.
  std::vector<bool> has_person;               ///< Whose words these are, or caused this.
  /// Words, a goal or a reason: whether they tell of each thing, then of each place, then of a
  /// stop.
  std::vector<bool> has_text;
  bool is_held = false;
  bool is_visible = false;
  size_t count = 0;
  Time first{};
  Time last{};
};

/// What a memory has of a question, as of `now`.
/// Errors: those of Memory::query.
Result<std::vector<EpisodeGroup>> episode_groups(KnownFacts& facts, const AskedNames& names,
                                                 const AskedTimes& times, Time now, DayZone zone);

/// Whether the filters of a program, times and programs in it apart, keep the records of a group.
[[nodiscard]] bool keeps(const Program& program, const EpisodeGroup& group,
                         const AskedNames& names);

/// A group as numbers, mostly flags.
[[nodiscard]] AttentionInput::Traits traits_of(const EpisodeGroup& group, const AskedNames& names,
                                               Time now);

/// The groups that have most to do with the question, at most AttentionInput::kMaxAttended.
[[nodiscard]] std::vector<uint32_t> attended_first(const std::vector<EpisodeGroup>& groups,
                                                   const AskedNames& names);

}  // namespace engram::speech
