// SPDX-License-Identifier: Apache-2.0
#include "speech/attention/choose_program.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "speech/attention/program_symbols.h"

namespace engram::speech {

namespace {

/// Each filter must be worth it: of programs that select the same the shortest is taken.
constexpr double kCostOfFilter = 0.05;
/// So many filters are tried together, and so many of the best programs for each of the two.
constexpr size_t kMaxChoices = 4096;
constexpr size_t kMaxKept = 64;

using Mentions = uint32_t;  ///< A bit for each name of the question.

/// One value of a filter, and which names of the question it has.
struct FilterValue {
  std::string text;
  Mentions mentions = 0;
};

/// A filter that a program may have: none of its values, or one.
struct FilterChoice {
  FilterKey key{};
  std::vector<FilterValue> values;
};

/// Filters that were chosen, with how well they fit.
struct ChosenFilters {
  std::vector<ProgramFilter> filters;
  Mentions mentions = 0;
  double score = 0;
};

/// The names of a question by their bits.
class MentionBits {
 public:
  explicit MentionBits(const AskedNames& names) {
    for (const auto* all : {&names.things, &names.places, &names.persons, &names.hands}) {
      first_.push_back(count_);
      count_ += all->size();
    }
  }
  [[nodiscard]] bool is_too_many() const { return count_ > 20; }
  /// Those that a program must have. "Left" and "right" are no hands in "what was left to do".
  [[nodiscard]] Mentions needed() const { return (Mentions{1} << first_.back()) - 1; }
  [[nodiscard]] Mentions thing(size_t i) const { return bit(0, i); }
  [[nodiscard]] Mentions place(size_t i) const { return bit(1, i); }
  [[nodiscard]] Mentions person(size_t i) const { return bit(2, i); }
  [[nodiscard]] Mentions hand(size_t i) const { return bit(3, i); }

 private:
  [[nodiscard]] Mentions bit(size_t kind, size_t i) const {
    return Mentions{1} << (first_[kind] + i);
  }

  std::vector<size_t> first_;
  size_t count_ = 0;
};

/// Each name alone, and all of them.
template <typename BitOf>
std::vector<FilterValue> values_of(const std::vector<std::string>& names, const BitOf& bit_of) {
  std::vector<FilterValue> values;
  FilterValue all;
  for (size_t i = 0; i < names.size(); ++i) {
    values.push_back({names[i], bit_of(i)});
    all.text += (i > 0 ? "," : "") + names[i];
    all.mentions |= bit_of(i);
  }
  if (names.size() > 1) values.push_back(all);
  return values;
}

std::vector<FilterChoice> choices_for(ProgramSource source, const AskedNames& names,
                                      const MentionBits& bits) {
  using Key = FilterKey;
  const auto things = values_of(names.things, [&](size_t i) { return bits.thing(i); });
  const auto places = values_of(names.places, [&](size_t i) { return bits.place(i); });
  const auto persons = values_of(names.persons, [&](size_t i) { return bits.person(i); });
  const auto hands = values_of(names.hands, [&](size_t i) { return bits.hand(i); });
  std::vector<FilterValue> skills;
  for (const std::string& one : names.skills) skills.push_back({one});
  if (names.skills.size() > 1) skills.push_back({names.all_skills()});
  std::vector<FilterValue> texts = things;
  texts.insert(texts.end(), places.begin(), places.end());
  std::erase_if(texts,
                [](const FilterValue& value) { return value.text.find(',') != std::string::npos; });
  texts.push_back({"stop"});
  const std::vector<FilterValue> outcomes{
      {"success"}, {"failure"}, {"stop"}, {"running"}, {"problem"}};
  const std::vector<FilterValue> yes{{"yes"}};
  switch (source) {
    case ProgramSource::kExecutions:
      return {{Key::kSkill, skills}, {Key::kThing, things},     {Key::kPlace, places},
              {Key::kHand, hands},   {Key::kOutcome, outcomes}, {Key::kSpeaker, persons}};
    case ProgramSource::kWords:
      return {{Key::kSpeaker, persons}, {Key::kText, texts}};
    case ProgramSource::kPlans:
      return {{Key::kThing, things}, {Key::kPlace, places}, {Key::kSpeaker, persons}};
    case ProgramSource::kRefusals:
      return {{Key::kSkill, skills}, {Key::kText, texts}};
    case ProgramSource::kDrives:
      return {{Key::kText, texts}};
    case ProgramSource::kThings:
      return {{Key::kThing, things},
              {Key::kPlace, places},
              {Key::kHand, hands},
              {Key::kIsHeld, yes},
              {Key::kVisible, yes}};
    case ProgramSource::kRobot:
      return {{Key::kPlace, places}};
  }
  return {};
}

/// All ways to choose filters, the best first.
class FilterSearch {
 public:
  FilterSearch(ProgramSource source, const std::vector<float>& logits,
               const std::vector<EpisodeGroup>& groups, const AskedNames& names,
               const MentionBits& bits)
      : names_(names), choices_(choices_for(source, names, bits)) {
    program_.source = source;
    for (size_t i = 0; i < groups.size(); ++i)
      if (groups[i].source == source) asked_.emplace_back(&groups[i], logits[i]);
  }

  std::vector<ChosenFilters> search() {
    choose(0, 0);
    std::stable_sort(found_.begin(), found_.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
    return std::move(found_);
  }

 private:
  void choose(size_t at, Mentions mentions) {
    if (tried_ == kMaxChoices) return;
    if (at == choices_.size()) {
      ++tried_;
      double score = -kCostOfFilter * static_cast<double>(program_.filters.size());
      for (const auto& [group, logit] : asked_)
        if (keeps(program_, *group, names_)) score += static_cast<double>(logit);
      found_.push_back({program_.filters, mentions, score});
      return;
    }
    choose(at + 1, mentions);
    for (const FilterValue& value : choices_[at].values) {
      // A name stands for a thing or in a text, and not for both.
      if ((mentions & value.mentions) != 0) continue;
      program_.filters.push_back({choices_[at].key, {value.text, nullptr}});
      choose(at + 1, mentions | value.mentions);
      program_.filters.pop_back();
    }
  }

  const AskedNames& names_;
  std::vector<FilterChoice> choices_;
  std::vector<std::pair<const EpisodeGroup*, float>> asked_;
  Program program_;
  std::vector<ChosenFilters> found_;
  size_t tried_ = 0;
};

/// The best score for each set of names that is said.
std::vector<ChosenFilters> best_by_mentions(std::vector<ChosenFilters> found) {
  std::vector<ChosenFilters> best;
  for (ChosenFilters& one : found) {
    const bool is_known = std::any_of(best.begin(), best.end(), [&](const ChosenFilters& other) {
      return other.mentions == one.mentions;
    });
    if (!is_known && best.size() < kMaxKept) best.push_back(std::move(one));
  }
  return best;
}

/// How surely the groups of a source are told apart as the program does: that of the least sure.
double least_sure(const Program& program, const std::vector<float>& logits,
                  const std::vector<EpisodeGroup>& groups, const AskedNames& names) {
  double least = 1;
  for (size_t i = 0; i < groups.size(); ++i) {
    if (groups[i].source != program.source) continue;
    const double sign = keeps(program, groups[i], names) ? 1 : -1;
    least = std::min(least, 1 / (1 + std::exp(-sign * static_cast<double>(logits[i]))));
  }
  return least;
}

Program with_filters(Program program, const ChosenFilters& chosen) {
  program.filters.insert(program.filters.begin(), chosen.filters.begin(), chosen.filters.end());
  return program;
}

Program joined(Program main, ProgramLink link, Program other) {
  const auto within = std::make_shared<const Program>(std::move(other));
  const auto filter = [&](FilterKey key) { main.filters.push_back({key, {{}, within}}); };
  const auto step = [&](StepKind kind) { main.steps.push_back({kind, Argument{{}, within}}); };
  switch (link) {
    case ProgramLink::kAfter:
      filter(FilterKey::kAfter);
      break;
    case ProgramLink::kBefore:
      filter(FilterKey::kBefore);
      break;
    case ProgramLink::kAt:
      filter(FilterKey::kAt);
      break;
    case ProgramLink::kMoreThan:
      step(StepKind::kMoreThan);
      break;
    case ProgramLink::kLessThan:
      step(StepKind::kLessThan);
      break;
    case ProgramLink::kEquals:
      step(StepKind::kEquals);
      break;
    case ProgramLink::kNone:
      break;
  }
  return main;
}

std::optional<AttendedProgram> program_of(const AttentionScores::Reading& reading,
                                          const std::vector<EpisodeGroup>& groups,
                                          const AskedNames& names, const AskedTimes& times,
                                          const MentionBits& bits) {
  const auto frame = frame_of(reading.symbols, times, names.all_skills());
  if (!frame) return {};
  const auto best = [&](const Program& program, const std::vector<float>& logits) {
    return best_by_mentions(FilterSearch(program.source, logits, groups, names, bits).search());
  };
  const std::vector<ChosenFilters> mains = best(frame->main, reading.main);
  const bool is_single = frame->link == ProgramLink::kNone;
  const std::vector<ChosenFilters> others =
      is_single ? std::vector<ChosenFilters>(1) : best(frame->other, reading.other);
  const ChosenFilters* main = nullptr;
  const ChosenFilters* other = nullptr;
  double score = -std::numeric_limits<double>::infinity();
  for (const ChosenFilters& one : mains)
    for (const ChosenFilters& two : others) {
      const Mentions said = one.mentions | two.mentions;
      if ((said & bits.needed()) != bits.needed() || one.score + two.score <= score) continue;
      main = &one;
      other = &two;
      score = one.score + two.score;
    }
  if (main == nullptr) return {};
  const Program chosen = with_filters(frame->main, *main);
  const Program within = is_single ? Program{} : with_filters(frame->other, *other);
  AttendedProgram attended{
      joined(chosen, frame->link, within),
      std::exp(reading.log_probability) * least_sure(chosen, reading.main, groups, names)};
  if (!is_single) attended.confidence *= least_sure(within, reading.other, groups, names);
  if (!attended.program.validate().ok()) return {};
  return attended;
}

}  // namespace

std::optional<AttendedProgram> choose_program(const AttentionScores& scores,
                                              const std::vector<EpisodeGroup>& groups,
                                              const AskedNames& names, const AskedTimes& times) {
  const MentionBits bits(names);
  if (bits.is_too_many()) return {};
  for (const AttentionScores::Reading& reading : scores.readings) {
    if (!reading.symbols.empty() && reading.symbols.front() == kRefusalSymbol) return {};
    if (auto program = program_of(reading, groups, names, times, bits)) return program;
  }
  return {};
}

}  // namespace engram::speech
