// SPDX-License-Identifier: Apache-2.0
#include "speech/learning/attention_layers.h"

#include "speech/attention/program_symbols.h"

namespace engram::speech {

namespace {

using Shape = AttentionShape;
constexpr double kDropout = 0.15;

torch::nn::Sequential two_layers() {
  return torch::nn::Sequential(
      torch::nn::Linear(static_cast<int64_t>(AttentionInput::kTraits), Shape::kWidth),
      torch::nn::GELU(), torch::nn::Linear(Shape::kWidth, Shape::kWidth));
}

}  // namespace

AttentionLayersImpl::AttentionLayersImpl() {
  const auto symbol_count = static_cast<int64_t>(program_symbols().size());
  parts = register_module(
      "parts",
      torch::nn::Embedding(
          torch::nn::EmbeddingOptions(AttentionInput::kParts, Shape::kWidth).padding_idx(0)));
  places = register_module(
      "places",
      torch::nn::Embedding(static_cast<int64_t>(AttentionInput::kMaxWords) + 8, Shape::kWidth));
  symbols = register_module("symbols", torch::nn::Embedding(symbol_count, Shape::kWidth));
  orders = register_module("orders", torch::nn::Embedding(Shape::kMaxSymbols, Shape::kWidth));
  traits = register_module("traits", two_layers());
  keys = register_module("keys", two_layers());
  readers = register_module(
      "readers", torch::nn::TransformerEncoder(torch::nn::TransformerEncoderOptions(
                     torch::nn::TransformerEncoderLayerOptions(Shape::kWidth, Shape::kHeads)
                         .dim_feedforward(Shape::kInner)
                         .dropout(kDropout)
                         .activation(torch::kGELU),
                     Shape::kReaders)));
  tellers = register_module(
      "tellers", torch::nn::TransformerDecoder(torch::nn::TransformerDecoderOptions(
                     torch::nn::TransformerDecoderLayerOptions(Shape::kWidth, Shape::kHeads)
                         .dim_feedforward(Shape::kInner)
                         .dropout(kDropout)
                         .activation(torch::kGELU),
                     Shape::kTellers)));
  next = register_module("next", torch::nn::Linear(Shape::kWidth, symbol_count));
  main_query = register_module("main_query", torch::nn::Linear(Shape::kWidth, Shape::kWidth));
  other_query = register_module("other_query", torch::nn::Linear(Shape::kWidth, Shape::kWidth));
  torch::NoGradGuard no_gradient;
  for (torch::nn::Embedding* embedding : {&parts, &places, &symbols, &orders})
    (*embedding)->weight.mul_(0.1);
}

torch::Tensor AttentionLayersImpl::read(const AttentionBatch& batch) {
  const int64_t count = batch.words.size(1);
  torch::Tensor of_words =
      parts(batch.words).sum(2) + places(torch::arange(count, torch::kLong)).unsqueeze(0);
  const torch::Tensor of_groups = traits->forward(batch.attended);
  const torch::Tensor all = torch::cat({of_words, of_groups}, 1).transpose(0, 1);
  return readers(all, torch::Tensor(), torch::cat({batch.no_word, batch.no_attended}, 1));
}

torch::Tensor AttentionLayersImpl::tell(const torch::Tensor& read, const AttentionBatch& batch,
                                        const torch::Tensor& told) {
  const int64_t count = told.size(1);
  const torch::Tensor all =
      (symbols(told) + orders(torch::arange(count, torch::kLong)).unsqueeze(0)).transpose(0, 1);
  const torch::Tensor later =
      torch::full({count, count}, -std::numeric_limits<float>::infinity()).triu(1);
  return tellers(all, read, later, torch::Tensor(), torch::Tensor(),
                 torch::cat({batch.no_word, batch.no_attended}, 1));
}

torch::Tensor AttentionLayersImpl::next_symbols(const torch::Tensor& told) {
  return next(told);
}

torch::Tensor AttentionLayersImpl::select(const torch::Tensor& told, const torch::Tensor& groups,
                                          bool is_within) {
  const torch::Tensor query = is_within ? other_query(told) : main_query(told);
  const torch::Tensor scores = torch::matmul(keys->forward(groups), query.unsqueeze(2)).squeeze(2);
  return scores / std::sqrt(static_cast<double>(Shape::kWidth));
}

}  // namespace engram::speech
