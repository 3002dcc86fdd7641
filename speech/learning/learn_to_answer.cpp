// SPDX-License-Identifier: Apache-2.0
#include "speech/learning/learn_to_answer.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "encoders/threads.h"
#include "ltm/core/log.h"
#include "speech/attention/asked_names.h"
#include "speech/attention/program_symbols.h"
#include "speech/learning/attention_batch.h"
#include "speech/learning/attention_weights.h"
#include "speech/learning/read_by_attention.h"

namespace engram::speech {

namespace {

constexpr size_t kMinExamples = 100;
constexpr int64_t kWarmUpSteps = 300;
constexpr double kWarmUpShare = 0.1;
/// A word that is no name is left out so often, and so often one of its parts, which are its verb,
/// its spelling and its base form: others use other words for the same.
constexpr double kForgottenWords = 0.08;
constexpr double kForgottenParts = 0.15;
/// What is kept is a mean of the weights over the last steps, which reads better than those of any
/// step (Polyak and Juditsky, 1992).
constexpr double kMeanDecay = 0.998;
constexpr size_t kMaxMeasured = 3000;
constexpr size_t kBatchesInWindow = 16;

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

/// Whether the likeliest reading is the one that was to be learned, and how sure it is.
struct Judged {
  bool is_new_wording = false;
  double confidence = 0;
  bool is_right = false;
  bool is_refusal = false;
};

double min_sureness(const std::vector<float>& logits, const std::vector<uint8_t>& flags,
                    bool& is_right) {
  double min_found = 1;
  for (size_t i = 0; i < flags.size() && i < logits.size(); ++i) {
    if (flags[i] == 2) continue;
    const bool is_kept = logits[i] > 0;
    is_right = is_right && is_kept == (flags[i] == 1);
    min_found = std::min(min_found, 1 / (1 + std::exp(-std::abs(static_cast<double>(logits[i])))));
  }
  return min_found;
}

Judged judge(AttentionLayers& layers, const AttentionExample& example) {
  AttentionInput input{.words = example.words, .attended = example.attended};
  for (const auto& traits : example.groups) input.groups.push_back(unpacked(traits));
  const AttentionScores scores = read_by_attention(layers, input);
  if (scores.readings.empty()) return {};
  const AttentionScores::Reading& best = scores.readings.front();
  Judged judged{.is_new_wording = example.is_new_wording};
  judged.is_refusal = best.symbols.front() == kRefusalSymbol;
  judged.is_right = best.symbols == example.symbols;
  judged.confidence = std::exp(best.log_probability);
  if (judged.is_refusal) return judged;
  judged.confidence *= min_sureness(best.main, example.main, judged.is_right);
  if (!best.other.empty())
    judged.confidence *= min_sureness(best.other, example.other, judged.is_right);
  return judged;
}

class Fit {
 public:
  Fit(std::vector<AttentionExample> examples, const LearnOptions& options)
      : examples_(std::move(examples)), options_(options), random_(options.seed) {
    for (const AttentionExample& one : examples_)
      (one.is_held_out ? held_out_ : learned_).push_back(&one);
    std::stable_sort(learned_.begin(), learned_.end(), [](const auto* a, const auto* b) {
      return a->words.size() < b->words.size();
    });
    torch::manual_seed(static_cast<int64_t>(options.seed));
    layers_ = AttentionLayers();
    if (options.start.empty()) return;
    auto start = read_attention(options.start);
    if (start.ok())
      layers_ = start->layers;
    else if (start.status().code() != StatusCode::kNotFound)
      log::warning("learning to answer starts anew: {}", start.status().message());
  }

  [[nodiscard]] size_t count() const { return learned_.size(); }

  Status train(const ProgressSink& progress, const std::stop_token& stop) {
    torch::optim::AdamW optimiser(
        layers_->parameters(),
        torch::optim::AdamWOptions(options_.learning_rate).weight_decay(0.01));
    const SteadyTime began = steady_now();
    const double budget = to_seconds(options_.budget);
    layers_->train();
    for (;; ++report_.steps) {
      if (stop.stop_requested()) return cancelled("learning to answer was stopped");
      const double share = to_seconds(steady_now() - began) / budget;
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
    report_.seconds = to_seconds(steady_now() - began);
    torch::NoGradGuard no_gradient;
    const auto weights = layers_->parameters();
    for (size_t i = 0; i < weights.size() && !mean_.empty(); ++i) weights[i].copy_(mean_[i]);
    return {};
  }

  Result<LearnReport> finish(const std::filesystem::path& file, const std::stop_token& stop) {
    report_.examples = learned_.size();
    for (const torch::Tensor& tensor : layers_->parameters()) report_.parameters += tensor.numel();
    layers_->eval();
    std::shuffle(held_out_.begin(), held_out_.end(), random_);
    held_out_.resize(std::min(held_out_.size(), kMaxMeasured));
    std::vector<Judged> all;
    for (const AttentionExample* one : held_out_) {
      if (stop.stop_requested()) return cancelled("learning to answer was stopped");
      all.push_back(judge(layers_, *one));
    }
    measure(std::move(all));
    ENGRAM_RETURN_IF_ERROR(save_attention(layers_,
                                          {report_.min_confidence, report_.sure_confidence,
                                           static_cast<int64_t>(report_.examples), report_.seconds},
                                          file));
    return report_;
  }

 private:
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
  /// words that nobody knows by chance.
  std::vector<AttentionExample> choose() {
    const auto wanted = static_cast<size_t>(options_.batch);
    const size_t window = std::min(learned_.size(), wanted * kBatchesInWindow);
    const size_t first = random_() % (learned_.size() - window + 1);
    std::vector<AttentionExample> chosen;
    for (size_t i = 0; i < wanted; ++i) {
      AttentionExample one = *learned_[first + random_() % window];
      for (AttentionInput::Word& word : one.words) forget(word);
      chosen.push_back(std::move(one));
    }
    return chosen;
  }

  /// A name has two parts; of what a time is, there is one.
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

  /// The least confidence of which enough are right; refusals tell nothing and are not counted.
  void measure(std::vector<Judged> all) {
    report_.held_out = all.size();
    if (all.empty()) return;
    const auto count = static_cast<double>(all.size());
    report_.read_rightly =
        static_cast<double>(
            std::count_if(all.begin(), all.end(), [](const Judged& one) { return one.is_right; })) /
        count;
    const auto new_wordings =
        std::count_if(all.begin(), all.end(), [](const Judged& one) { return one.is_new_wording; });
    if (new_wordings > 0)
      report_.new_wordings_read_rightly =
          static_cast<double>(
              std::count_if(all.begin(), all.end(),
                            [](const Judged& one) { return one.is_new_wording && one.is_right; })) /
          static_cast<double>(new_wordings);
    std::erase_if(all, [](const Judged& one) { return one.is_refusal; });
    std::sort(all.begin(), all.end(),
              [](const Judged& a, const Judged& b) { return a.confidence > b.confidence; });
    size_t right = 0;
    for (size_t i = 0; i < all.size(); ++i) {
      right += all[i].is_right ? 1 : 0;
      const double share = static_cast<double>(right) / static_cast<double>(i + 1);
      if (share >= options_.sure_right) report_.sure_confidence = all[i].confidence;
      if (share < options_.min_right) continue;
      report_.min_confidence = all[i].confidence;
      report_.told = static_cast<double>(i + 1) / count;
      report_.told_rightly = share;
    }
  }

  std::vector<AttentionExample> examples_;
  const LearnOptions& options_;
  std::mt19937_64 random_;
  std::vector<const AttentionExample*> learned_;
  std::vector<const AttentionExample*> held_out_;
  AttentionLayers layers_{nullptr};
  std::vector<torch::Tensor> mean_;  ///< Of the weights.
  LearnReport report_;
};

}  // namespace

Status LearnOptions::validate() const {
  if (budget <= Duration::zero())
    return invalid_argument("learning to answer: found a budget of {} s, needs more than 0",
                            to_seconds(budget));
  if (batch < 1 || batch > 1024)
    return invalid_argument("learning to answer: found a batch of {}, needs 1 to 1024", batch);
  if (!(learning_rate > 0 && learning_rate < 1))
    return invalid_argument("learning to answer: found a rate of {}, needs 0 to 1", learning_rate);
  if (!(min_right >= 0 && min_right <= 1))
    return invalid_argument("learning to answer: found {} to be right, needs 0 to 1", min_right);
  return {};
}

Result<LearnReport> learn_to_answer(std::vector<AttentionExample> examples,
                                    const LearnOptions& options, const std::filesystem::path& file,
                                    const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return encoders::guarded("learning to answer", [&]() -> Result<LearnReport> {
    encoders::set_threads(options.threads);
    Fit fit(std::move(examples), options);
    if (fit.count() < kMinExamples)
      return invalid_argument("learning to answer: found {} examples, needs {}", fit.count(),
                              kMinExamples);
    ENGRAM_RETURN_IF_ERROR(fit.train(progress, stop));
    return fit.finish(file, stop);
  });
}

Result<LessonReport> learn_from(const Lesson& lesson, const ProgressSink& progress,
                                const std::stop_token& stop) {
  LessonReport report;
  std::vector<AttentionExample> examples;
  ExampleOptions options = lesson.examples;
  for (size_t i = 0; i < lesson.stores.size(); ++i) {
    if (progress)
      progress({.what = "make dialogues",
                .done = i,
                .total = lesson.stores.size(),
                .detail = fmt::format("{} examples", examples.size())});
    ENGRAM_ASSIGN_OR_RETURN(
        const auto memory,
        Memory::open(lesson.stores[i], {.is_read_only = true, .notes_reads = false}));
    ENGRAM_ASSIGN_OR_RETURN(const ExampleCounts made,
                            add_examples(*memory, options, stop, examples));
    report.dialogues += made;
    // Each store has its own choice of dialogues, and of the fillings of each wording.
    options.dialogues.seed += 100;
  }
  ENGRAM_ASSIGN_OR_RETURN(report.learned, learn_to_answer(std::move(examples), lesson.options,
                                                          lesson.file, progress, stop));
  return report;
}

}  // namespace engram::speech
