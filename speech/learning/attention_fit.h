// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <vector>

#include "speech/learning/attention_layers.h"
#include "speech/learning/learn_to_answer.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// Trains the layers on examples until the time is over, and leaves the mean of their weights over
/// the last steps in them. Fills steps, seconds and loss of the report.
/// Errors: kCancelled; those of `options.pause`.
Status fit_attention(AttentionLayers& layers, std::vector<const AttentionExample*> examples,
                     const LearnOptions& options, LearnReport& report, const ProgressSink& progress,
                     const std::stop_token& stop);

}  // namespace engram::speech
