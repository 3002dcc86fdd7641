// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "speech/learning/attention_layers.h"
#include "speech/learning/dialogue_examples.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// Questions side by side with what is to be learned of them.
struct LearnedBatch {
  AttentionBatch questions;
  torch::Tensor begun;    ///< [B, S]: kBeginSymbol and the symbols.
  torch::Tensor symbols;  ///< [B, S]: the symbols and kEndSymbol; -1 behind it.
  torch::Tensor main;     ///< [B, G]: 0, 1, and -1 where nothing is learned.
  torch::Tensor other;    ///< The same of the program within.
  torch::Tensor link;     ///< [B]: the place of the source within among `begun`; 0: none.
};

/// Puts examples side by side.
[[nodiscard]] LearnedBatch batch_of(std::span<const AttentionExample* const> examples);

/// One question.
[[nodiscard]] AttentionBatch batch_of(const AttentionInput& input);

}  // namespace engram::speech
