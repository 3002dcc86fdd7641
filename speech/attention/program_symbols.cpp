// SPDX-License-Identifier: Apache-2.0
#include "speech/attention/program_symbols.h"

#include <algorithm>
#include <array>
#include <map>

#include "speech/program/filter_texts.h"

namespace engram::speech {

namespace {

using Key = FilterKey;

constexpr std::array kSources{ProgramSource::kExecutions, ProgramSource::kWords,
                              ProgramSource::kPlans,      ProgramSource::kRefusals,
                              ProgramSource::kDrives,     ProgramSource::kThings,
                              ProgramSource::kRobot};
constexpr std::array kTimeKeys{Key::kDuring, Key::kAt, Key::kAfter, Key::kBefore};
constexpr std::array<const char*, 6> kTimeValues{"during", "at",  "after",
                                                 "before", "now", "always"};
/// The program within stands in a filter of time, or in a step that compares.
constexpr std::array kLinkKeys{Key::kAfter, Key::kBefore, Key::kAt};
constexpr std::array kLinkSteps{StepKind::kMoreThan, StepKind::kLessThan, StepKind::kEquals};
/// Steps without an argument.
constexpr std::array kSteps{
    StepKind::kFirst,       StepKind::kLast,         StepKind::kLongest,   StepKind::kShortest,
    StepKind::kPrevious,    StepKind::kNext,         StepKind::kFirstSeen, StepKind::kLastSeen,
    StepKind::kCount,       StepKind::kExists,       StepKind::kNone,      StepKind::kEvents,
    StepKind::kWhen,        StepKind::kAgo,          StepKind::kEnded,     StepKind::kSpan,
    StepKind::kHowLong,     StepKind::kHowFar,       StepKind::kWhere,     StepKind::kFrom,
    StepKind::kWho,         StepKind::kWhoStopped,   StepKind::kSaid,      StepKind::kWhy,
    StepKind::kReason,      StepKind::kSucceeded,    StepKind::kRetried,   StepKind::kInstead,
    StepKind::kInsteadNext, StepKind::kInsteadWhere, StepKind::kHolder,    StepKind::kIsVisible,
    StepKind::kWasMoved};
constexpr std::array kWhat{"thing", "hand", "skill", "place", "person", "colour"};
constexpr std::array<const char*, 5> kOutcomes{"success", "failure", "stop", "running", "problem"};
/// Which of the names of a question; "all" are those of a kind, joined by commas.
constexpr std::array<const char*, 4> kPointers{"0", "1", "2", "all"};
constexpr std::array kPointingKeys{Key::kSkill, Key::kThing, Key::kPlace, Key::kHand,
                                   Key::kSpeaker};
constexpr const char* kStopSymbol = "text=stop";
/// What stands between a filter or a step and its value: a pointer, a text, or a verb.
constexpr std::string_view kSigns = ":=~";
/// The order of filters among symbols.
constexpr std::array kFilterOrder{
    Key::kSkill,  Key::kThing,   Key::kPlace,  Key::kHand, Key::kOutcome, Key::kSpeaker, Key::kText,
    Key::kIsHeld, Key::kVisible, Key::kDuring, Key::kAt,   Key::kAfter,   Key::kBefore};

std::string text(std::string_view first, char sign, std::string_view second) {
  return std::string(first) + sign + std::string(second);
}

std::string link_name(std::string_view name) {
  return "(" + std::string(name) + ")";
}

int32_t symbol_named(const std::string& name) {
  static const auto kByName = [] {
    std::map<std::string, int32_t> by_name;
    for (const std::string& symbol : program_symbols())
      by_name.emplace(symbol, static_cast<int32_t>(by_name.size()));
    return by_name;
  }();
  const auto found = kByName.find(name);
  return found == kByName.end() ? -1 : found->second;
}

bool is_among(const auto& all, auto one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

const std::vector<std::string>& names_of_key(const AskedNames& names, Key key) {
  if (key == Key::kSkill) return names.skills;
  if (key == Key::kPlace) return names.places;
  if (key == Key::kHand) return names.hands;
  return key == Key::kSpeaker ? names.persons : names.things;
}

/// What a pointer points at; nothing: the question has not so many.
std::optional<std::string> pointed_at(const std::vector<std::string>& names,
                                      std::string_view pointer) {
  if (pointer == "all") return names.size() < 2 ? std::nullopt : std::optional(any_of_names(names));
  const auto index = static_cast<size_t>(pointer.front() - '0');
  return index < names.size() ? std::optional(names[index]) : std::nullopt;
}

std::optional<std::string> pointer_to(const std::vector<std::string>& names,
                                      const std::string& value) {
  for (const char* pointer : kPointers)
    if (pointed_at(names, pointer) == value) return pointer;
  return {};
}

std::optional<std::string> text_of_time(std::string_view value, const AskedTimes& times) {
  if (value == "during") return times.during;
  if (value == "at") return times.at;
  if (value == "after") return times.after;
  if (value == "before") return times.before;
  return std::string(value);
}

/// Skills as a verb of English, or as a pointer at what the question calls them.
std::string symbol_of_skills(std::string_view key, const std::string& skills,
                             const AskedNames& names) {
  for (size_t i = 0; i < names.skills_of_verbs.size(); ++i)
    if (!skills.empty() && names.skills_of_verbs[i] == skills)
      return text(key, '~', skill_verbs()[i].base);
  const auto pointer = pointer_to(names.skills, skills);
  return pointer ? text(key, ':', *pointer) : std::string();
}

/// The skills of a verb of English.
std::optional<std::string> skills_of_verb(std::string_view base, const AskedNames& names) {
  for (size_t i = 0; i < names.skills_of_verbs.size(); ++i)
    if (skill_verbs()[i].base == base && !names.skills_of_verbs[i].empty())
      return names.skills_of_verbs[i];
  return {};
}

/// A filter as a symbol; empty: the language has not got it.
std::string symbol_of_filter(const ProgramFilter& filter, const AskedNames& names,
                             const AskedTimes& times) {
  const std::string& value = filter.value.text;
  const std::string_view key = name_of(filter.key);
  if (filter.key == Key::kSkill) return symbol_of_skills(key, value, names);
  if (is_among(kPointingKeys, filter.key)) {
    const auto pointer = pointer_to(names_of_key(names, filter.key), value);
    return pointer ? text(key, ':', *pointer) : std::string();
  }
  if (is_among(kTimeKeys, filter.key)) {
    for (const char* time : kTimeValues)
      if (text_of_time(time, times) == value) return text(key, ':', time);
    return {};
  }
  if (filter.key != Key::kText) return text(key, '=', value);
  if (value == "stop") return kStopSymbol;
  if (const auto thing = pointer_to(names.things, value)) return "text:thing" + *thing;
  if (const auto place = pointer_to(names.places, value)) return "text:place" + *place;
  return {};
}

/// The filter that a symbol tells; nothing: it is none, or points at nothing.
std::optional<ProgramFilter> filter_of_symbol(std::string_view symbol, const AskedNames& names,
                                              const AskedTimes& times) {
  const auto with = [](Key key, std::optional<std::string> value) -> std::optional<ProgramFilter> {
    if (!value) return {};
    return ProgramFilter{key, {*std::move(value), nullptr}};
  };
  const size_t sign = symbol.find_first_of(kSigns);
  if (sign == std::string_view::npos) return {};
  const auto key = filter_named(symbol.substr(0, sign));
  if (!key) return {};
  std::string_view value = symbol.substr(sign + 1);
  if (symbol[sign] == '~') return with(*key, skills_of_verb(value, names));
  if (symbol[sign] == '=') return with(*key, std::string(value));
  if (is_among(kPointingKeys, *key))
    return with(*key, pointed_at(names_of_key(names, *key), value));
  if (is_among(kTimeKeys, *key)) return with(*key, text_of_time(value, times));
  constexpr std::string_view kOfThing = "thing";
  const bool is_thing = value.starts_with(kOfThing);
  value.remove_prefix(kOfThing.size());  // "place" is as long.
  return with(*key, pointed_at(is_thing ? names.things : names.places, value));
}

/// Writes a program as symbols.
class SymbolWriter {
 public:
  SymbolWriter(const AskedNames& names, const AskedTimes& times) : names_(names), times_(times) {}

  bool write(const Program& program, bool is_within = false) {
    add(std::string(name_of(program.source)));
    size_t told = 0;
    std::string link;
    for (const Key key : kFilterOrder)
      for (const ProgramFilter& filter : program.filters) {
        if (filter.key != key) continue;
        ++told;
        if (filter.value.program != nullptr) {
          if (!link.empty() || !is_among(kLinkKeys, key)) return false;
          link = link_name(name_of(key));
        } else {
          add(symbol_of_filter(filter, names_, times_));
        }
      }
    if (told != program.filters.size()) return false;
    for (const ProgramStep& step : program.steps) {
      if (!step.argument || !step.argument->program) {
        add(symbol_of_step(step));
        continue;
      }
      if (!link.empty()) return false;
      link = link_name(name_of(step.kind));
    }
    const Program* within = program_within(program);
    if (within == nullptr || !is_sound_) return is_sound_;
    if (is_within) return false;
    add(link);
    return write(*within, true);
  }

  [[nodiscard]] std::vector<int32_t> take() {
    symbols_.push_back(kEndSymbol);
    return std::move(symbols_);
  }

 private:
  void add(const std::string& name) {
    const int32_t symbol = symbol_named(name);
    is_sound_ = is_sound_ && symbol >= 0;
    symbols_.push_back(symbol);
  }

  [[nodiscard]] std::string symbol_of_step(const ProgramStep& step) const {
    const std::string_view name = name_of(step.kind);
    if (!step.argument) return std::string(name);
    return step.kind == StepKind::kInsteadHas ? symbol_of_skills(name, step.argument->text, names_)
                                              : text(name, '=', step.argument->text);
  }

  const AskedNames& names_;
  const AskedTimes& times_;
  std::vector<int32_t> symbols_;
  bool is_sound_ = true;
};

/// Reads symbols as a program.
class SymbolReader {
 public:
  SymbolReader(std::vector<std::string> symbols, const AskedNames& names, const AskedTimes& times)
      : symbols_(std::move(symbols)), names_(names), times_(times) {}

  std::optional<Program> read(bool is_within = false) {
    if (at_ >= symbols_.size()) return {};
    const auto source = source_named(symbols_[at_]);
    if (!source) return {};
    Program program{*source, {}, {}};
    for (++at_; at_ < symbols_.size(); ++at_) {
      const std::string& symbol = symbols_[at_];
      if (symbol.starts_with('(')) return is_within ? std::nullopt : linked(std::move(program));
      if (auto filter = filter_of_symbol(symbol, names_, times_)) {
        if (program.find(filter->key) != nullptr) return {};
        program.filters.push_back(*std::move(filter));
      } else if (!add_step(symbol, program)) {
        return {};
      }
    }
    return program;
  }

 private:
  bool add_step(const std::string& symbol, Program& program) const {
    const size_t sign = symbol.find_first_of(kSigns);
    const auto step = step_named(std::string_view(symbol).substr(0, sign));
    if (!step) return false;
    if (sign == std::string::npos) {
      program.then(*step);
      return true;
    }
    std::string argument = symbol.substr(sign + 1);
    if (symbol[sign] != '=') {
      const auto skills = symbol[sign] == ':' ? pointed_at(names_.skills, argument)
                                              : skills_of_verb(argument, names_);
      if (!skills) return false;
      argument = *skills;
    }
    program.then(*step, std::move(argument));
    return true;
  }

  std::optional<Program> linked(Program main) {
    const std::string name = symbols_[at_].substr(1, symbols_[at_].size() - 2);
    ++at_;
    auto other = read(true);
    if (!other) return {};
    const auto within = std::make_shared<const Program>(*std::move(other));
    if (const auto key = filter_named(name); key && is_among(kLinkKeys, *key)) {
      if (main.find(*key) != nullptr) return {};
      main.filters.push_back({*key, {{}, within}});
      return main;
    }
    const auto step = step_named(name);
    if (!step) return {};
    main.steps.push_back({*step, Argument{{}, within}});
    return main;
  }

  const std::vector<std::string> symbols_;
  const AskedNames& names_;
  const AskedTimes& times_;
  size_t at_ = 0;
};

}  // namespace

const std::vector<std::string>& program_symbols() {
  static const auto kSymbols = [] {
    std::vector<std::string> all{"(end)", "(begin)", "(refused)"};
    // What begins with a parenthesis behind these is a link: link_place().
    for (const Key key : kLinkKeys) all.push_back(link_name(name_of(key)));
    for (const StepKind step : kLinkSteps) all.push_back(link_name(name_of(step)));
    for (const ProgramSource source : kSources) all.emplace_back(name_of(source));
    for (const Key key : kPointingKeys)
      for (const char* pointer : kPointers) all.push_back(text(name_of(key), ':', pointer));
    for (const SkillVerb& verb : skill_verbs())
      all.push_back(text(name_of(Key::kSkill), '~', verb.base));
    for (const char* outcome : kOutcomes) all.push_back(text(name_of(Key::kOutcome), '=', outcome));
    for (const char* kind : {"thing", "place"})
      for (const char* pointer : {"0", "1", "2"})
        all.push_back("text:" + std::string(kind) + pointer);
    all.emplace_back(kStopSymbol);
    for (const Key key : {Key::kIsHeld, Key::kVisible})
      for (const char* value : {"yes", "no"}) all.push_back(text(name_of(key), '=', value));
    for (const Key key : kTimeKeys)
      for (const char* value : kTimeValues) all.push_back(text(name_of(key), ':', value));
    for (const StepKind step : kSteps) all.emplace_back(name_of(step));
    for (const StepKind step : {StepKind::kWhich, StepKind::kHowMany})
      for (const char* what : kWhat) all.push_back(text(name_of(step), '=', what));
    all.push_back(text(name_of(StepKind::kHowMany), '=', "step"));
    for (const char* nth : {"2", "3", "4", "5"})
      all.push_back(text(name_of(StepKind::kNth), '=', nth));
    for (const char* pointer : kPointers)
      all.push_back(text(name_of(StepKind::kInsteadHas), ':', pointer));
    for (const SkillVerb& verb : skill_verbs())
      all.push_back(text(name_of(StepKind::kInsteadHas), '~', verb.base));
    return all;
  }();
  return kSymbols;
}

const Program* program_within(const Program& program) {
  for (const ProgramFilter& filter : program.filters)
    if (filter.value.program) return filter.value.program.get();
  for (const ProgramStep& step : program.steps)
    if (step.argument && step.argument->program) return step.argument->program.get();
  return nullptr;
}

std::optional<std::vector<int32_t>> symbols_of(const Program& program, const AskedNames& names,
                                               const AskedTimes& times) {
  SymbolWriter writer(names, times);
  if (!writer.write(program)) return {};
  return writer.take();
}

std::optional<Program> program_told(const std::vector<int32_t>& symbols, const AskedNames& names,
                                    const AskedTimes& times) {
  const std::vector<std::string>& known = program_symbols();
  std::vector<std::string> told;
  for (const int32_t symbol : symbols) {
    if (symbol == kEndSymbol) break;
    if (symbol < 0 || static_cast<size_t>(symbol) >= known.size()) return {};
    told.push_back(known[static_cast<size_t>(symbol)]);
  }
  auto program = SymbolReader(std::move(told), names, times).read();
  if (!program || !program->validate().ok()) return {};
  return program;
}

std::optional<size_t> link_place(const std::vector<int32_t>& symbols) {
  constexpr auto kLinks = static_cast<int32_t>(kLinkKeys.size() + kLinkSteps.size());
  for (size_t at = 0; at < symbols.size(); ++at)
    if (symbols[at] > kRefusalSymbol && symbols[at] <= kRefusalSymbol + kLinks) return at;
  return {};
}

}  // namespace engram::speech
