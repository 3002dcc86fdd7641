// SPDX-License-Identifier: Apache-2.0
#include "speech/telling/tell_period.h"

#include <algorithm>
#include <map>

#include "ltm/core/printable.h"
#include "speech/facts/facts_as_of.h"
#include "speech/telling/phrases.h"

namespace engram::speech {

namespace {

/// Actions without a plan that begin so soon after each other are told together.
constexpr Duration kSameChapter = std::chrono::minutes(5);
constexpr size_t kMaxLinks = 50;
constexpr size_t kMaxPhrases = 6;

bool is_problem(const Execution& execution) {
  return execution.outcome == ltm::ActionOutcome::kFailure ||
         execution.outcome == ltm::ActionOutcome::kStop;
}

/// No end of it is known: it goes on, or it was lost.
bool is_endless(const Execution& execution) {
  return execution.outcome == ltm::ActionOutcome::kRunning ||
         execution.outcome == ltm::ActionOutcome::kUnknown;
}

/// What belongs together: the executions of a plan, or those of no plan one after the other.
struct Chapter {
  const TaskPlan* plan = nullptr;
  std::vector<const Execution*> executions;
  std::vector<const Execution*> problems;
};

/// A chapter in words, before it is decided which sentences there is room for.
struct ToldChapter {
  NarrationSentence what;
  std::vector<NarrationSentence> problems;
};

std::vector<Chapter> chapters_of(const FactsAsOf& facts, Period period) {
  std::vector<Chapter> chapters;
  std::map<ltm::MemoryId, size_t> of_plan;
  std::optional<Time> last_without_plan;
  size_t without_plan = 0;
  for (const Execution* one : facts.executions()) {
    const Execution& execution = *one;
    if (!period.contains(execution.started)) continue;
    size_t chapter = chapters.size();
    if (execution.plan) {
      chapter = of_plan.try_emplace(*execution.plan, chapters.size()).first->second;
    } else {
      if (last_without_plan && execution.started - *last_without_plan < kSameChapter)
        chapter = without_plan;
      without_plan = chapter;
      last_without_plan = execution.started;
    }
    if (chapter == chapters.size()) chapters.emplace_back();
    chapters[chapter].executions.push_back(&execution);
    if (is_problem(execution) || is_endless(execution))
      chapters[chapter].problems.push_back(&execution);
    if (execution.plan) chapters[chapter].plan = facts.plan_at(*execution.plan);
  }
  return chapters;
}

void link(NarrationSentence& told, const ltm::MemoryId& id) {
  if (told.links.size() < kMaxLinks) told.links.push_back(id);
}

/// What was done, each thing once, in the order of its last success.
std::string done_text(const Chapter& chapter, const KnownWorld& world) {
  std::vector<std::string> phrases;
  for (const Execution* execution : chapter.executions) {
    if (execution->outcome != ltm::ActionOutcome::kSuccess) continue;
    Execution without_hand = *execution;
    without_hand.hand.clear();
    std::string phrase = past_phrase(without_hand, world);
    const auto known = std::find(phrases.begin(), phrases.end(), phrase);
    if (known != phrases.end()) phrases.erase(known);
    phrases.push_back(std::move(phrase));
  }
  if (phrases.empty()) return "nothing that I began succeeded";
  if (phrases.size() > kMaxPhrases) {
    const size_t left = phrases.size() - kMaxPhrases + 1;
    phrases.resize(kMaxPhrases - 1);
    phrases.push_back(fmt::format("did {} more", counted(left, "thing")));
  }
  return "I " + joined(phrases);
}

NarrationSentence told_problem(const Execution& execution, const FactsAsOf& facts, DayZone zone) {
  NarrationSentence told{NarrationLevel::kFailure, {}, {}};
  std::string text = fmt::format("{} {}", spoken_time(execution.started, facts.now(), zone),
                                 outcome_phrase(execution, facts.world()));
  link(told, execution.start_id);
  if (execution.end_id) link(told, *execution.end_id);
  for (const ltm::MemoryId& id : execution.stopped_by) {
    const SpokenWords* words = facts.words_at(id);
    if (words != nullptr) text += fmt::format(" ({})", words_phrase(*words));
    link(told, id);
  }
  told.text = sentence(std::move(text));
  return told;
}

ToldChapter told_chapter(const Chapter& chapter, const FactsAsOf& facts, DayZone zone) {
  ToldChapter told{{NarrationLevel::kPlan, {}, {}}, {}};
  std::string text = spoken_time(chapter.executions.front()->started, facts.now(), zone) + " ";
  if (chapter.plan != nullptr) {
    link(told.what, chapter.plan->id);
    const SpokenWords* words =
        chapter.plan->command ? facts.words_at(*chapter.plan->command) : nullptr;
    if (words != nullptr) {
      text += words_phrase(*words) + " So ";
      link(told.what, words->id);
    } else {
      text += fmt::format("I planned: {}. ", printable(chapter.plan->goal));
    }
  }
  text += done_text(chapter, facts.world());
  for (const Execution* execution : chapter.executions) link(told.what, execution->start_id);
  told.what.text = sentence(std::move(text));
  for (const Execution* execution : chapter.problems)
    told.problems.push_back(told_problem(*execution, facts, zone));
  return told;
}

NarrationSentence told_whole(const std::vector<Chapter>& chapters, Time now, DayZone zone) {
  NarrationSentence told{NarrationLevel::kWhole, {}, {}};
  size_t executions = 0;
  size_t failed = 0;
  size_t stopped = 0;
  size_t endless = 0;
  size_t plans = 0;
  const Execution* first = chapters.front().executions.front();
  const Execution* last = first;
  Time end = first->started;
  for (const Chapter& chapter : chapters) {
    executions += chapter.executions.size();
    if (chapter.plan != nullptr) ++plans;
    for (const Execution* execution : chapter.executions) {
      if (execution->started > last->started) last = execution;
      end = std::max(end, execution->ended.value_or(execution->started));
      if (execution->outcome == ltm::ActionOutcome::kFailure) ++failed;
      if (execution->outcome == ltm::ActionOutcome::kStop) ++stopped;
      if (is_endless(*execution)) ++endless;
    }
  }
  std::string text = fmt::format("{} I carried out {}", spoken_span(first->started, end, now, zone),
                                 counted(executions, "action"));
  if (plans > 0) text += " for " + counted(plans, "task");
  std::vector<std::string> parts;
  if (failed > 0) parts.push_back(fmt::format("{} failed", failed));
  if (stopped > 0)
    parts.push_back(fmt::format("{} {} stopped", stopped, stopped == 1 ? "was" : "were"));
  if (endless > 0) parts.push_back(fmt::format("of {} no end is known", endless));
  if (!parts.empty()) text += "; " + joined(parts);
  told.text = sentence(std::move(text));
  link(told, first->start_id);
  link(told, last->start_id);
  return told;
}

/// Which chapters there is room for: those with problems first, and then the longest.
std::vector<bool> chosen(const std::vector<ToldChapter>& told, size_t room) {
  std::vector<size_t> order(told.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    if (told[a].problems.size() != told[b].problems.size())
      return told[a].problems.size() > told[b].problems.size();
    return told[a].what.links.size() > told[b].what.links.size();
  });
  std::vector<bool> is_chosen(told.size());
  for (size_t i = 0; i < std::min(room, order.size()); ++i) is_chosen[order[i]] = true;
  return is_chosen;
}

}  // namespace

std::string_view name_of(NarrationLevel level) {
  switch (level) {
    case NarrationLevel::kWhole:
      return "whole";
    case NarrationLevel::kPlan:
      return "plan";
    case NarrationLevel::kFailure:
      break;
  }
  return "failure";
}

Result<std::vector<NarrationSentence>> tell_period(KnownFacts& facts, Period period, Time now,
                                                   DayZone zone, size_t max_sentences) {
  std::vector<NarrationSentence> narration;
  const FactsAsOf as_of(facts, now);
  const std::vector<Chapter> chapters = chapters_of(as_of, period);
  if (chapters.empty() || max_sentences == 0) return narration;
  narration.push_back(told_whole(chapters, now, zone));
  std::vector<ToldChapter> told;
  for (const Chapter& chapter : chapters) told.push_back(told_chapter(chapter, as_of, zone));
  // One sentence is kept for what there is no room for.
  size_t room = max_sentences - narration.size();
  if (told.size() > room && room > 0) --room;
  const std::vector<bool> is_chosen = chosen(told, room);
  size_t left = room - std::min(room, told.size());
  NarrationSentence rest{NarrationLevel::kPlan, {}, {}};
  size_t unchosen = 0;
  for (size_t i = 0; i < told.size(); ++i) {
    if (!is_chosen[i]) {
      ++unchosen;
      if (!told[i].what.links.empty()) link(rest, told[i].what.links.front());
      continue;
    }
    const size_t problems = std::min(left, told[i].problems.size());
    left -= problems;
    // A problem without a sentence of its own is counted with its plan.
    if (const size_t untold = told[i].problems.size() - problems; untold > 0)
      told[i].what.text +=
          fmt::format(" {} of it went wrong.", untold == 1 ? "One step" : counted(untold, "step"));
    narration.push_back(std::move(told[i].what));
    for (size_t p = 0; p < problems; ++p) narration.push_back(std::move(told[i].problems[p]));
  }
  if (unchosen > 0 && narration.size() < max_sentences) {
    rest.text = fmt::format("Besides, I carried out {} more.", counted(unchosen, "task"));
    narration.push_back(std::move(rest));
  }
  return narration;
}

}  // namespace engram::speech
