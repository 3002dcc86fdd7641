// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "ltm/memory/member_prediction.h"
#include "ltm/prediction/member_choice.h"

// Private to this room.

namespace engram::ltm {

/// Says of each member how it was predicted, and how wrong the whole may be: the means over the
/// elements of what counts, images apart from numbers. Where nothing is promised of a member that
/// counts, nothing is promised of the whole. A model's own estimate stands for images; of numbers
/// it is one for all, so what was measured of each stands before it.
void summarize(const ValueRow& rows, const std::vector<MemberCandidate>& candidates,
               const std::vector<MemberChoice>& choices, const std::vector<bool>& is_moving,
               const std::map<const Engine*, Prediction>& models,
               std::vector<MemberPrediction>& members, ErrorEstimate& error);

/// Of a value that has another layout than those before it: as one member.
[[nodiscard]] MemberPrediction whole_prediction(const Engine& model, const Prediction& predicted);

}  // namespace engram::ltm
