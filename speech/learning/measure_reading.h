// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <vector>

#include "speech/learning/attention_layers.h"
#include "speech/learning/learn_to_answer.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// Reads the trials among the held-out examples just as questions are read later, and finds the
/// confidences from which on enough is right. Fills held_out and all that follows it in the report.
/// Errors: kCancelled.
Status measure_reading(AttentionLayers& layers, const std::vector<AttentionExample>& examples,
                       const LearnOptions& options, LearnReport& report,
                       const std::stop_token& stop);

}  // namespace engram::speech
