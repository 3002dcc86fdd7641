// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/torch.h"
#include "speech/attention/attention_input.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// Sizes of a network. The defaults make about two million parameters.
struct AttentionShape {
  static constexpr int64_t kWidth = 128;
  static constexpr int64_t kHeads = 4;
  static constexpr int64_t kInner = 384;
  static constexpr int64_t kReaders = 3;  ///< Layers that read the question and the groups.
  static constexpr int64_t kTellers = 2;  ///< Layers that tell the program.
  static constexpr int64_t kMaxSymbols = 26;
};

/// Questions side by side. B questions have at most L words, A groups that are attended to, G
/// groups that are selected from, and S symbols.
struct AttentionBatch {
  torch::Tensor words;        ///< [B, L, kPartsPerWord], numbers of parts; 0 is none.
  torch::Tensor no_word;      ///< [B, L], true behind the end.
  torch::Tensor attended;     ///< [B, A, kTraits]
  torch::Tensor no_attended;  ///< [B, A]
  torch::Tensor groups;       ///< [B, G, kTraits]
};

/// The route of attention's network.
///
///     words ----.                            (begin) source times steps ...
///                +-- readers --.                         |
///     groups ---'               '------ attended by --- tellers --+-- the next symbol
///                                                                 |
///     groups -- keys ------------------- times the query of -----'    whether a group is selected
///
/// Source: Vaswani et al., Attention Is All You Need, 2017, in the layers of LibTorch. That a
/// question attends to the memory, and that what is said is pointed at in it, is of the paper,
/// section on verbalisation; the pointers of See et al., Get To The Point, 2017, point at words,
/// and these at groups of episodes.
struct AttentionLayersImpl : torch::nn::Module {
  AttentionLayersImpl();

  /// What the question and the groups are to each other. Shape: [L + A, B, kWidth].
  torch::Tensor read(const AttentionBatch& batch);
  /// Shape: symbols [B, S] -> [S, B, kWidth]. Each sees those before it.
  torch::Tensor tell(const torch::Tensor& read, const AttentionBatch& batch,
                     const torch::Tensor& symbols);
  /// Shape: [S, B, kWidth] -> logits [S, B, symbols].
  torch::Tensor next_symbols(const torch::Tensor& told);
  /// Logits of groups [B, G] for queries [B, kWidth] of the program, or of that within it.
  torch::Tensor select(const torch::Tensor& told, const torch::Tensor& groups, bool is_within);

  torch::nn::Embedding parts{nullptr}, places{nullptr}, symbols{nullptr}, orders{nullptr};
  torch::nn::Sequential traits{nullptr}, keys{nullptr};
  torch::nn::TransformerEncoder readers{nullptr};
  torch::nn::TransformerDecoder tellers{nullptr};
  torch::nn::Linear next{nullptr}, main_query{nullptr}, other_query{nullptr};
};
TORCH_MODULE(AttentionLayers);

}  // namespace engram::speech
