// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/core/status.h"
#include "speech/learning/attention_layers.h"
#include "speech/learning/learn_to_answer.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// What is kept beside the weights.
struct AttentionRecord {
  double min_confidence = kNeverSure;
  double sure_confidence = kNeverSure;
  int64_t examples = 0;  ///< That it was trained with.
  double seconds = 0;    ///< Of training.
};

/// Writes a whole file under another name and publishes it in one step.
/// Errors: kUnavailable.
Status save_attention(AttentionLayers& layers, const AttentionRecord& record,
                      const std::filesystem::path& path);

struct SavedAttention {
  AttentionLayers layers;
  AttentionRecord record;
};

/// Errors: those of load_attention.
Result<SavedAttention> read_attention(const std::filesystem::path& path);

}  // namespace engram::speech
