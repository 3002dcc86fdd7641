// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/prediction/engine_choice.h"
#include "ltm/prediction/member_record.h"
#include "ltm/prediction/value_row.h"

// Private to this room.

namespace engram::ltm {

/// An engine that may predict the members of a value, with its measured errors at one horizon.
struct MemberCandidate {
  std::string engine;
  const Engine* model = nullptr;       ///< Null for a series engine.
  std::vector<MotionRecords> members;  ///< One per member of the layout.

  [[nodiscard]] bool is_measured() const;
};

/// The candidate that predicts a member, and its measured error. The record is empty if no error is
/// stated.
struct MemberChoice {
  size_t candidate = 0;
  MemberRecord record;
};

/// Min moments of one kind (moving or at rest) that a choice and a bound are based on. With fewer,
/// moments of the other kind or of the whole past may be used.
inline constexpr size_t kMinMoments = 10;
/// A member gets an engine of its own only if that has at most this share of the squared error of
/// the engine that is best for all members. Among many engines one is always a little better by
/// chance.
inline constexpr double kClearGain = 0.9;

/// Chooses for each member of the layout the candidate that was best for it in its present state
/// (`is_moving`, one per member). The first candidate must copy the last value (checked); members
/// that can only be copied get it.
/// Source: docs/prediction.md, section "Which engine answers".
[[nodiscard]] std::vector<MemberChoice> choose_members(
    const std::vector<MemberCandidate>& candidates, const ValueRow& rows,
    const std::vector<bool>& is_moving);

/// Chooses the last candidate for all members that it can predict: a series engine for those in
/// rows, a model for all. The others get the first candidate.
[[nodiscard]] std::vector<MemberChoice> named_members(
    const std::vector<MemberCandidate>& candidates, const ValueRow& rows,
    const std::vector<bool>& is_moving);

}  // namespace engram::ltm
