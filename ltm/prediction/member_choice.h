// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/prediction/engine_choice.h"
#include "ltm/prediction/member_record.h"
#include "ltm/prediction/value_row.h"

// Private to this room.

namespace engram::ltm {

/// An engine that may continue the members of a value, with what it was worth one horizon ahead.
struct MemberCandidate {
  std::string engine;
  const Engine* model = nullptr;       ///< Null of an engine of numbers.
  std::vector<MotionRecords> members;  ///< By member of the layout.

  [[nodiscard]] bool is_measured() const;
};

/// Which candidate continues a member, and what is known of its error; nothing where none is told.
struct MemberChoice {
  size_t candidate = 0;
  MemberRecord record;
};

/// With fewer moments of the kind at hand (moving, at rest) nothing is promised from these alone.
inline constexpr size_t kMinMoments = 10;
/// A member has an engine of its own where that has at most this share of the squared error of the
/// one that is best for all: of many engines one is always a little better by chance.
inline constexpr double kClearGain = 0.9;

/// For each member of the layout, the candidate that was best for it in the state that it is in
/// (`is_moving`, by member). The first candidate copies the last value (checked): all that only is
/// copied stays with it. Source: docs/prediction.md, section "Which engine answers".
[[nodiscard]] std::vector<MemberChoice> choose_members(
    const std::vector<MemberCandidate>& candidates, const ValueRow& rows,
    const std::vector<bool>& is_moving);

/// The same where the last candidate is to continue all that it can: an engine of numbers those
/// that are in rows, a model all.
[[nodiscard]] std::vector<MemberChoice> named_members(
    const std::vector<MemberCandidate>& candidates, const ValueRow& rows,
    const std::vector<bool>& is_moving);

}  // namespace engram::ltm
