// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "ltm/memory/member_prediction.h"
#include "ltm/prediction/member_choice.h"

// Private to this room.

namespace engram::ltm {

/// Describes how each member was predicted, and the error of the whole: the means over the elements
/// of the members that count, images apart from numbers. If the error of a member that counts is
/// unknown, so is that of the whole. For images a model's own estimate is preferred to measured
/// errors. For numbers the measured errors are preferred, because they are per member while the
/// model's estimate is one for all.
void summarize(const ValueRow& rows, const std::vector<MemberCandidate>& candidates,
               const std::vector<MemberChoice>& choices, const std::vector<bool>& is_moving,
               const std::map<const Engine*, Prediction>& models,
               std::vector<MemberPrediction>& members, ErrorEstimate& error);

/// Describes a value that has another layout than the values before it, as one member.
[[nodiscard]] MemberPrediction whole_prediction(const Engine& model, const Prediction& predicted);

}  // namespace engram::ltm
