// SPDX-License-Identifier: Apache-2.0
#include "speech/learning/learn_to_answer.h"

#include <algorithm>

#include "encoders/threads.h"
#include "ltm/core/log.h"
#include "speech/learning/attention_fit.h"
#include "speech/learning/attention_weights.h"
#include "speech/learning/measure_reading.h"

namespace engram::speech {

namespace {

constexpr size_t kMinExamples = 100;
/// Measuring takes about so long, and is part of the time that ends at a moment.
constexpr Duration kMeasuring = std::chrono::seconds(30);

/// Where a lesson is kept that was cut off, behind the name of its file.
constexpr const char* kUnfinished = ".unfinished";

/// Those of a lesson that was cut off, else those that the options name, else new ones.
Result<AttentionLayers> layers_to_begin_with(const std::filesystem::path& unfinished,
                                             const LearnOptions& options) {
  const bool learns = options.budget > Duration::zero();
  if (auto kept = read_attention(unfinished); learns && kept.ok()) {
    log::info("learning to answer goes on from '{}'", unfinished.string());
    return kept->layers;
  }
  if (options.start.empty()) return AttentionLayers();
  ENGRAM_ASSIGN_OR_RETURN(const SavedAttention start, read_attention(options.start));
  return start.layers;
}

Result<LearnReport> learn(const std::vector<AttentionExample>& examples,
                          const LearnOptions& options, const std::filesystem::path& file,
                          const ProgressSink& progress, const std::stop_token& stop) {
  std::vector<const AttentionExample*> learned;
  for (const AttentionExample& one : examples)
    if (one.trial == nullptr) learned.push_back(&one);
  if (learned.size() < kMinExamples)
    return invalid_argument("learning to answer: found {} examples, needs {}", learned.size(),
                            kMinExamples);
  encoders::set_threads(options.threads);
  torch::manual_seed(static_cast<int64_t>(options.seed));
  std::filesystem::path unfinished = file;
  unfinished += kUnfinished;
  ENGRAM_ASSIGN_OR_RETURN(AttentionLayers layers, layers_to_begin_with(unfinished, options));
  LearnReport report{.examples = learned.size()};
  for (const torch::Tensor& tensor : layers->parameters()) report.parameters += tensor.numel();
  const auto keep = [&](AttentionLayers& kept) {
    return save_attention(kept, {.examples = static_cast<int64_t>(report.examples)}, unfinished);
  };
  if (options.budget > Duration::zero())
    ENGRAM_RETURN_IF_ERROR(
        fit_attention(layers, std::move(learned), options, report, keep, progress, stop));
  layers->eval();
  ENGRAM_RETURN_IF_ERROR(measure_reading(layers, examples, options, report, stop));
  ENGRAM_RETURN_IF_ERROR(save_attention(layers,
                                        {report.min_confidence, report.sure_confidence,
                                         static_cast<int64_t>(report.examples), report.seconds},
                                        file));
  std::error_code error;
  std::filesystem::remove(unfinished, error);
  return report;
}

}  // namespace

Status LearnOptions::validate() const {
  if (budget < Duration::zero() || (budget == Duration::zero() && start.empty()))
    return invalid_argument("learning to answer: found a budget of {} s, needs more than 0",
                            to_seconds(budget));
  if (batch < 1 || batch > 1024)
    return invalid_argument("learning to answer: found a batch of {}, needs 1 to 1024", batch);
  if (!(learning_rate > 0 && learning_rate < 1))
    return invalid_argument("learning to answer: found a rate of {}, needs 0 to 1", learning_rate);
  for (const double share : {min_right, sure_right, min_refused})
    if (!(share >= 0 && share <= 1))
      return invalid_argument("learning to answer: found a share of {}, needs 0 to 1", share);
  return {};
}

Result<LearnReport> learn_to_answer(const std::vector<AttentionExample>& examples,
                                    const LearnOptions& options, const std::filesystem::path& file,
                                    const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return encoders::guarded("learning to answer", [&]() -> Result<LearnReport> {
    return learn(examples, options, file, progress, stop);
  });
}

Result<LessonReport> learn_from(const Lesson& lesson, const ProgressSink& progress,
                                const std::stop_token& stop) {
  LessonReport report;
  std::vector<AttentionExample> examples;
  ExampleOptions made_of = lesson.examples;
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
                            add_examples(*memory, made_of, stop, examples));
    report.dialogues += made;
    // Each store has its own choice of dialogues, and of the fillings of each wording.
    made_of.dialogues.seed += 100;
  }
  LearnOptions options = lesson.options;
  if (lesson.until) {
    options.budget = std::min(options.budget, *lesson.until - system_now() - kMeasuring);
    if (options.budget <= Duration::zero() && lesson.options.budget > Duration::zero())
      return resource_exhausted("learning to answer: no time is left for it");
  }
  ENGRAM_ASSIGN_OR_RETURN(report.learned,
                          learn_to_answer(examples, options, lesson.file, progress, stop));
  return report;
}

}  // namespace engram::speech
