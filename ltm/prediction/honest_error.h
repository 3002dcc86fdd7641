// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "ltm/prediction/instance_history.h"

// Private to this room.

namespace engram::ltm {

/// The mean error of copying the last value, over the moments that `errors` are of and over all
/// members that count.
[[nodiscard]] MeasuredError copied_baseline(
    const InstanceHistory& history, const std::vector<std::pair<size_t, MemberErrors>>& errors,
    Duration ahead);

/// Raises a model's errors on an entity's past to its errors on held-out data, if those are
/// clearly larger.
///
/// The model may have been trained on the same past that engines are measured on. There its errors
/// are smaller than they will be later, and it would be chosen for that. The held-out errors
/// (Predictor::records) are scaled by the error of a copy here relative to that of a copy there,
/// because some moments are easier than others for both. If no copy was measured they are not
/// scaled.
void make_honest(const EngineChoiceInputs& inputs, const idf::Layout& layout, const Engine& model,
                 int steps, const MeasuredError& copied,
                 std::vector<std::pair<size_t, MemberErrors>>& errors);

}  // namespace engram::ltm
