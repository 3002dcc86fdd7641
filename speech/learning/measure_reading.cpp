// SPDX-License-Identifier: Apache-2.0
#include "speech/learning/measure_reading.h"

#include <algorithm>

#include "speech/attention/choose_program.h"
#include "speech/learning/read_by_attention.h"

namespace engram::speech {

namespace {

constexpr size_t kMaxTrials = 2000;
/// Fewer wordings that are held out say too little, and then all questions are taken.
constexpr size_t kMinNewWordings = 200;

/// What was read of a question that was held out.
struct Judged {
  bool is_new_wording = false;
  bool is_answerable = false;
  bool is_refused = false;
  bool is_right = false;
  double confidence = 0;
};

Judged judge(AttentionLayers& layers, const AttentionExample& example) {
  const AttentionTrial& trial = *example.trial;
  const auto chosen = choose_program(read_by_attention(layers, trial.asked.input),
                                     trial.asked.groups, trial.asked.names, trial.asked.times);
  Judged judged{.is_new_wording = example.is_new_wording,
                .is_answerable = trial.program.has_value(),
                .is_refused = !chosen};
  if (chosen) judged.confidence = chosen->confidence;
  judged.is_right = chosen ? trial.program == chosen->program : !trial.program;
  return judged;
}

double share_of(const std::vector<Judged>& all, bool Judged::*flag) {
  const auto count =
      std::count_if(all.begin(), all.end(), [&](const Judged& one) { return one.*flag; });
  return all.empty() ? 0 : static_cast<double>(count) / static_cast<double>(all.size());
}

/// The lowest confidence from which on enough of what is told is right, and below which enough of
/// what cannot be answered is refused. Refusals tell nothing, so they count where it is measured
/// how much is told or refused, and not where it is measured how much of what is told is right.
void find_limits(std::vector<Judged> all, const LearnOptions& options, LearnReport& report) {
  const auto count = static_cast<double>(all.size());
  const auto unanswerable = static_cast<double>(
      std::count_if(all.begin(), all.end(), [](const Judged& one) { return !one.is_answerable; }));
  std::erase_if(all, [](const Judged& one) { return one.is_refused; });
  std::sort(all.begin(), all.end(),
            [](const Judged& a, const Judged& b) { return a.confidence > b.confidence; });
  size_t right = 0;
  size_t answered_wrongly = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    right += all[i].is_right ? 1 : 0;
    answered_wrongly += all[i].is_answerable ? 0 : 1;
    const double share = static_cast<double>(right) / static_cast<double>(i + 1);
    const double refused =
        unanswerable > 0 ? 1 - static_cast<double>(answered_wrongly) / unanswerable : 1;
    if (share >= options.sure_right) report.sure_confidence = all[i].confidence;
    if (share < options.min_right || refused < options.min_refused) continue;
    report.min_confidence = all[i].confidence;
    report.told = static_cast<double>(i + 1) / count;
    report.told_rightly = share;
    report.refused = refused;
  }
  report.sure_confidence = std::max(report.sure_confidence, report.min_confidence);
}

}  // namespace

Status measure_reading(AttentionLayers& layers, const std::vector<AttentionExample>& examples,
                       const LearnOptions& options, LearnReport& report,
                       const std::stop_token& stop) {
  std::vector<const AttentionExample*> trials;
  for (const AttentionExample& example : examples)
    if (example.trial != nullptr) trials.push_back(&example);
  // Some of all stores, where there are more than there is time for.
  const size_t step = 1 + trials.size() / kMaxTrials;
  std::vector<Judged> all;
  for (size_t i = 0; i < trials.size(); i += step) {
    if (stop.stop_requested()) return cancelled("learning to answer was stopped");
    all.push_back(judge(layers, *trials[i]));
  }
  report.held_out = all.size();
  report.read_rightly = share_of(all, &Judged::is_right);
  std::vector<Judged> new_wordings = all;
  std::erase_if(new_wordings, [](const Judged& one) { return !one.is_new_wording; });
  report.new_wordings_read_rightly = share_of(new_wordings, &Judged::is_right);
  const bool has_enough = new_wordings.size() >= kMinNewWordings;
  find_limits(has_enough ? std::move(new_wordings) : std::move(all), options, report);
  return {};
}

}  // namespace engram::speech
