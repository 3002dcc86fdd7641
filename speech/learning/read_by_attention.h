// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "speech/learning/attention_layers.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// The likeliest readings of one question, found by a beam of kReadings.
[[nodiscard]] AttentionScores read_by_attention(AttentionLayers& layers,
                                                const AttentionInput& input);

inline constexpr size_t kReadings = 4;

}  // namespace engram::speech
