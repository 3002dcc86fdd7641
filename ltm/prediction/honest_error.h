// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "ltm/prediction/instance_history.h"

// Private to this room.

namespace engram::ltm {

/// The mean error of copies over the same moments as `errors` are of, over all that counts.
[[nodiscard]] MeasuredError copied_baseline(
    const InstanceHistory& history, const std::vector<std::pair<size_t, MemberErrors>>& errors,
    Duration ahead);

/// Raises a model's errors on an entity's past to what it is worth on data that it was not trained
/// on, where that is more.
///
/// The past that engines are measured on may be what the model learned from last night: there it is
/// better than it will ever be again, and would be chosen for that. What held-out data told (
/// Predictor::records) counts relative to a copy there and here, for a moment may be easier than
/// another for both; where no copy was measured it counts as it is.
void make_honest(const EngineChoiceInputs& inputs, const idf::Layout& layout, const Engine& model,
                 int steps, const MeasuredError& copied,
                 std::vector<std::pair<size_t, MemberErrors>>& errors);

}  // namespace engram::ltm
