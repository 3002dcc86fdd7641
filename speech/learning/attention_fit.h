// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "speech/learning/attention_layers.h"
#include "speech/learning/learn_to_answer.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// Keeps what was learned so far: layers with the mean weights.
using KeepLayers = std::function<Status(AttentionLayers& layers)>;

/// Trains the layers on examples until the time is over, and leaves the mean of their weights over
/// the last steps in them. Fills steps, seconds and loss of the report. Calls `keep` each minute,
/// and before it ends early.
/// Errors: kCancelled; those of `options.pause` and `keep`.
Status fit_attention(AttentionLayers& layers, std::vector<const AttentionExample*> examples,
                     const LearnOptions& options, LearnReport& report, const KeepLayers& keep,
                     const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::speech
