// SPDX-License-Identifier: Apache-2.0
#include "speech/learning/attention_fit.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "speech/attention/asked_names.h"
#include "speech/learning/attention_batch.h"

namespace engram::speech {

namespace {

constexpr int64_t kWarmUpSteps = 300;
constexpr double kWarmUpShare = 0.1;
/// A word that is no name is left out so often, and so often one of its parts, which are its verb,
/// its spelling and its base form: others use other words for the same.
constexpr double kForgottenWords = 0.08;
constexpr double kForgottenParts = 0.15;
/// What is kept is a mean of the weights over the last steps, which reads better than those of any
/// step (Polyak and Juditsky, 1992).
constexpr double kMeanDecay = 0.998;
constexpr size_t kBatchesInWindow = 16;
constexpr double kKeepEvery_s = 60;

/// The cross entropy of the symbols, and that of the selections.
torch::Tensor loss_of(AttentionLayers& layers, const LearnedBatch& batch) {
  namespace nn = torch::nn::functional;
  const torch::Tensor read = layers->read(batch.questions);
  const torch::Tensor told = layers->tell(read, batch.questions, batch.begun);
  const torch::Tensor next = layers->next_symbols(told);
  torch::Tensor loss = nn::cross_entropy(next.flatten(0, 1),
                                         batch.symbols.transpose(0, 1).flatten().to(torch::kLong),
                                         nn::CrossEntropyFuncOptions().ignore_index(-1));
  const auto select = [&](const torch::Tensor& states, const torch::Tensor& wanted,
                          bool is_within) {
    const torch::Tensor is_asked = wanted.ge(0).to(torch::kFloat);
    const torch::Tensor logits = layers->select(states, batch.questions.groups, is_within);
    const torch::Tensor each = nn::binary_cross_entropy_with_logits(
        logits, wanted.clamp_min(0),
        nn::BinaryCrossEntropyWithLogitsFuncOptions().reduction(torch::kNone));
    return (each * is_asked).sum() / is_asked.sum().clamp_min(1);
  };
  if (told.size(0) > 1) {
    loss = loss + select(told[1], batch.main, false);
    const torch::Tensor place = batch.link.to(torch::kLong).view({1, -1, 1});
    const torch::Tensor states =
        told.gather(0, place.expand({1, told.size(1), told.size(2)})).squeeze(0);
    loss = loss + select(states, batch.other, true);
  }
  return loss;
}

/// One training.
class AttentionFit {
 public:
  AttentionFit(AttentionLayers& layers, std::vector<const AttentionExample*> examples,
               const LearnOptions& options, LearnReport& report)
      : layers_(layers),
        examples_(std::move(examples)),
        options_(options),
        report_(report),
        random_(options.seed) {
    std::stable_sort(examples_.begin(), examples_.end(), [](const auto* a, const auto* b) {
      return a->words.size() < b->words.size();
    });
  }

  Status train(const KeepLayers& keep, const ProgressSink& progress, const std::stop_token& stop) {
    torch::optim::AdamW optimiser(
        layers_->parameters(),
        torch::optim::AdamWOptions(options_.learning_rate).weight_decay(0.01));
    const SteadyTime began = steady_now();
    Duration paused{0};
    const double budget = to_seconds(options_.budget);
    layers_->train();
    for (;; ++report_.steps) {
      const SteadyTime before = steady_now();
      Status goes_on = options_.pause ? options_.pause() : Status();
      if (stop.stop_requested()) goes_on = cancelled("learning to answer was stopped");
      if (!goes_on.ok()) {
        if (report_.steps > 0) ENGRAM_RETURN_IF_ERROR(keep_mean(keep));
        return goes_on;
      }
      paused += steady_now() - before;
      report_.seconds = to_seconds(steady_now() - began - paused);
      if (report_.seconds - kept_ >= kKeepEvery_s) {
        kept_ = report_.seconds;
        ENGRAM_RETURN_IF_ERROR(keep_mean(keep));
      }
      const double share = report_.seconds / budget;
      if (share >= 1) break;
      set_rate(optimiser, share);
      const std::vector<AttentionExample> chosen = choose();
      std::vector<const AttentionExample*> pointers;
      for (const AttentionExample& one : chosen) pointers.push_back(&one);
      optimiser.zero_grad();
      const torch::Tensor loss = loss_of(layers_, batch_of(pointers));
      loss.backward();
      torch::nn::utils::clip_grad_norm_(layers_->parameters(), 1.0);
      optimiser.step();
      take_mean();
      tell(loss.item<double>(), share, budget, progress);
    }
    if (!mean_.empty()) set_weights(layers_, mean_);
    layers_->eval();
    return {};
  }

 private:
  static void set_weights(AttentionLayers& layers, const std::vector<torch::Tensor>& weights) {
    torch::NoGradGuard no_gradient;
    const auto own = layers->parameters();
    for (size_t i = 0; i < own.size(); ++i) own[i].copy_(weights[i]);
  }

  Status keep_mean(const KeepLayers& keep) {
    AttentionLayers kept;
    set_weights(kept, mean_);
    return keep(kept);
  }

  void take_mean() {
    torch::NoGradGuard no_gradient;
    const auto weights = layers_->parameters();
    if (mean_.empty())
      for (const torch::Tensor& tensor : weights) mean_.push_back(tensor.clone());
    // The first steps are soon forgotten.
    const double decay = std::min(kMeanDecay, static_cast<double>(report_.steps + 1) /
                                                  static_cast<double>(report_.steps + 10));
    for (size_t i = 0; i < weights.size(); ++i) mean_[i].mul_(decay).add_(weights[i], 1 - decay);
  }

  void set_rate(torch::optim::AdamW& optimiser, double share) const {
    // Where there is little time, it warms up in a part of it.
    const double steps = static_cast<double>(report_.steps + 1) / kWarmUpSteps;
    const double warm = std::min(1.0, std::max(steps, share / kWarmUpShare));
    const double cool = 0.02 + 0.98 * 0.5 * (1 + std::cos(M_PI * std::min(share, 1.0)));
    for (auto& group : optimiser.param_groups())
      static_cast<torch::optim::AdamWOptions&>(group.options())
          .lr(options_.learning_rate * warm * cool);
  }

  /// Examples by chance among those of like length, or the longest would decide what all cost; with
  /// words and parts of words left out by chance.
  std::vector<AttentionExample> choose() {
    const auto wanted = static_cast<size_t>(options_.batch);
    const size_t window = std::min(examples_.size(), wanted * kBatchesInWindow);
    const size_t first = random_() % (examples_.size() - window + 1);
    std::vector<AttentionExample> chosen;
    for (size_t i = 0; i < wanted; ++i) {
      AttentionExample one = *examples_[first + random_() % window];
      for (AttentionInput::Word& word : one.words) forget(word);
      chosen.push_back(std::move(one));
    }
    return chosen;
  }

  /// What a time is has one part, and stays.
  void forget(AttentionInput::Word& word) {
    const auto count =
        std::count_if(word.begin(), word.end(), [](int32_t part) { return part != 0; });
    if (count < 2 || is_name(word)) return;
    std::uniform_real_distribution<double> share(0, 1);
    if (share(random_) < kForgottenWords) {
      word.fill(0);
      return;
    }
    for (int32_t& part : word)
      if (share(random_) < kForgottenParts) part = 0;
  }

  void tell(double loss, double share, double budget, const ProgressSink& progress) {
    // The mean of about a hundred steps, and of fewer where there are no more.
    const double memory = std::max(0.01, 1.0 / static_cast<double>(report_.steps + 1));
    report_.loss = (1 - memory) * report_.loss + memory * loss;
    if (!progress || report_.steps % 20 != 0) return;
    progress({.what = "learn to answer",
              .done = static_cast<uint64_t>(share * budget),
              .total = static_cast<uint64_t>(budget),
              .detail = fmt::format("step {}, loss {:.3f}", report_.steps, report_.loss),
              .seconds_left = (1 - share) * budget});
  }

  AttentionLayers& layers_;
  std::vector<const AttentionExample*> examples_;
  const LearnOptions& options_;
  LearnReport& report_;
  std::mt19937_64 random_;
  std::vector<torch::Tensor> mean_;  ///< Of the weights.
  double kept_ = 0;                  ///< When, in seconds of learning.
};

}  // namespace

Status fit_attention(AttentionLayers& layers, std::vector<const AttentionExample*> examples,
                     const LearnOptions& options, LearnReport& report, const KeepLayers& keep,
                     const ProgressSink& progress, const std::stop_token& stop) {
  return AttentionFit(layers, std::move(examples), options, report).train(keep, progress, stop);
}

}  // namespace engram::speech
