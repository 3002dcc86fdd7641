// SPDX-License-Identifier: Apache-2.0
#include "speech/attention/program_symbols.h"

#include <algorithm>
#include <array>
#include <map>

namespace engram::speech {

namespace {

constexpr std::array kSources{ProgramSource::kExecutions, ProgramSource::kWords,
                              ProgramSource::kPlans,      ProgramSource::kRefusals,
                              ProgramSource::kDrives,     ProgramSource::kThings,
                              ProgramSource::kRobot};
constexpr std::array kTimeKeys{FilterKey::kDuring, FilterKey::kAt, FilterKey::kAfter,
                               FilterKey::kBefore};
constexpr std::array<const char*, 6> kTimeValues{"during", "at",  "after",
                                                 "before", "now", "always"};
constexpr std::array kLinks{ProgramLink::kAfter,    ProgramLink::kBefore,   ProgramLink::kAt,
                            ProgramLink::kMoreThan, ProgramLink::kLessThan, ProgramLink::kEquals};
constexpr std::array<const char*, 6> kLinkNames{"(after)",     "(before)",    "(at)",
                                                "(more_than)", "(less_than)", "(equals)"};
/// Steps without an argument.
constexpr std::array kSteps{
    StepKind::kFirst,       StepKind::kLast,         StepKind::kLongest,   StepKind::kShortest,
    StepKind::kPrevious,    StepKind::kNext,         StepKind::kFirstSeen, StepKind::kLastSeen,
    StepKind::kCount,       StepKind::kExists,       StepKind::kNone,      StepKind::kEvents,
    StepKind::kWhen,        StepKind::kAgo,          StepKind::kEnded,     StepKind::kSpan,
    StepKind::kHowLong,     StepKind::kHowFar,       StepKind::kWhere,     StepKind::kFrom,
    StepKind::kWho,         StepKind::kWhoStopped,   StepKind::kSaid,      StepKind::kWhy,
    StepKind::kReason,      StepKind::kSucceeded,    StepKind::kRetried,   StepKind::kInstead,
    StepKind::kInsteadNext, StepKind::kInsteadWhere, StepKind::kHolder,    StepKind::kIsVisible};
constexpr std::array<const char*, 5> kWhat{"thing", "hand", "skill", "place", "person"};
/// The skills of the question's verbs stand for the argument of instead_has.
constexpr const char* kAskedSkills = "{skills}";

std::string name_of_step(StepKind kind, std::string_view argument) {
  const std::string name(name_of(kind));
  return argument.empty() ? name : name + "=" + std::string(argument);
}

std::string name_of_time(FilterKey key, std::string_view value) {
  return std::string(name_of(key)) + ":" + std::string(value);
}

/// The text that a time filter has, and what it is called: "now", or which of the asked times.
std::optional<std::string> text_of_time(std::string_view value, const AskedTimes& times) {
  if (value == "during") return times.during;
  if (value == "at") return times.at;
  if (value == "after") return times.after;
  if (value == "before") return times.before;
  return std::string(value);
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

bool is_time_key(FilterKey key) {
  return std::find(kTimeKeys.begin(), kTimeKeys.end(), key) != kTimeKeys.end();
}

ProgramLink link_of(FilterKey key) {
  if (key == FilterKey::kAfter) return ProgramLink::kAfter;
  if (key == FilterKey::kBefore) return ProgramLink::kBefore;
  return key == FilterKey::kAt ? ProgramLink::kAt : ProgramLink::kNone;
}

ProgramLink link_of(StepKind kind) {
  if (kind == StepKind::kMoreThan) return ProgramLink::kMoreThan;
  if (kind == StepKind::kLessThan) return ProgramLink::kLessThan;
  return kind == StepKind::kEquals ? ProgramLink::kEquals : ProgramLink::kNone;
}

/// Writes a program as symbols.
class SymbolWriter {
 public:
  explicit SymbolWriter(const AskedTimes& times) : times_(times) {}

  bool write(const Program& program) {
    add(std::string(name_of(program.source)));
    ProgramLink link = ProgramLink::kNone;
    std::shared_ptr<const Program> other;
    for (const ProgramFilter& filter : program.filters) {
      if (!is_time_key(filter.key)) continue;
      if (filter.value.program == nullptr) {
        if (!add_time(filter)) return false;
        continue;
      }
      if (other != nullptr || link_of(filter.key) == ProgramLink::kNone) return false;
      link = link_of(filter.key);
      other = filter.value.program;
    }
    for (const ProgramStep& step : program.steps) {
      if (step.argument && step.argument->program) {
        if (other != nullptr) return false;
        link = link_of(step.kind);
        other = step.argument->program;
        continue;
      }
      std::string argument = step.argument ? step.argument->text : std::string();
      if (step.kind == StepKind::kInsteadHas) argument = kAskedSkills;
      add(name_of_step(step.kind, argument));
    }
    if (other == nullptr) return is_sound_;
    if (is_within_ || link == ProgramLink::kNone) return false;
    is_within_ = true;
    const auto at = std::find(kLinks.begin(), kLinks.end(), link) - kLinks.begin();
    add(kLinkNames[static_cast<size_t>(at)]);
    return write(*other);
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

  bool add_time(const ProgramFilter& filter) {
    for (const char* value : kTimeValues) {
      const auto text = text_of_time(value, times_);
      if (!text || *text != filter.value.text) continue;
      add(name_of_time(filter.key, value));
      return true;
    }
    return false;
  }

  const AskedTimes& times_;
  std::vector<int32_t> symbols_;
  bool is_sound_ = true;
  bool is_within_ = false;
};

/// Reads one program of a frame; `at` is then at the symbol that it does not have.
bool read_program(const std::vector<std::string>& names, size_t& at, const AskedTimes& times,
                  const std::string& skills, Program& program) {
  if (at >= names.size()) return false;
  const auto source = source_named(names[at]);
  if (!source) return false;
  program.source = *source;
  for (++at; at < names.size(); ++at) {
    const std::string& name = names[at];
    if (const size_t colon = name.find(':'); colon != std::string::npos) {
      const auto key = filter_named(name.substr(0, colon));
      const auto text = text_of_time(std::string_view(name).substr(colon + 1), times);
      if (!key || !text || program.find(*key) != nullptr) return false;
      program.with(*key, *text);
      continue;
    }
    const size_t equals = name.find('=');
    const auto step = step_named(name.substr(0, equals));
    if (!step) return true;
    if (equals == std::string::npos) {
      program.then(*step);
      continue;
    }
    std::string argument = name.substr(equals + 1);
    if (argument == kAskedSkills) argument = skills;
    if (argument.empty()) return false;
    program.then(*step, std::move(argument));
  }
  return true;
}

}  // namespace

const std::vector<std::string>& program_symbols() {
  static const auto kSymbols = [] {
    std::vector<std::string> all{"(end)", "(begin)", "(refused)"};
    for (const ProgramSource source : kSources) all.emplace_back(name_of(source));
    for (const FilterKey key : kTimeKeys)
      for (const char* value : kTimeValues) all.push_back(name_of_time(key, value));
    all.insert(all.end(), kLinkNames.begin(), kLinkNames.end());
    for (const StepKind step : kSteps) all.emplace_back(name_of(step));
    for (const StepKind step : {StepKind::kWhich, StepKind::kHowMany})
      for (const char* what : kWhat) all.push_back(name_of_step(step, what));
    for (const char* nth : {"2", "3", "4", "5"}) all.push_back(name_of_step(StepKind::kNth, nth));
    all.push_back(name_of_step(StepKind::kInsteadHas, kAskedSkills));
    return all;
  }();
  return kSymbols;
}

std::optional<std::vector<int32_t>> symbols_of(const Program& program, const AskedTimes& times) {
  SymbolWriter writer(times);
  if (!writer.write(program)) return {};
  return writer.take();
}

std::optional<ProgramFrame> frame_of(const std::vector<int32_t>& symbols, const AskedTimes& times,
                                     const std::string& skills) {
  const std::vector<std::string>& known = program_symbols();
  std::vector<std::string> names;
  for (const int32_t symbol : symbols) {
    if (symbol == kEndSymbol) break;
    if (symbol < 0 || static_cast<size_t>(symbol) >= known.size()) return {};
    names.push_back(known[static_cast<size_t>(symbol)]);
  }
  ProgramFrame frame;
  size_t at = 0;
  if (!read_program(names, at, times, skills, frame.main)) return {};
  if (at == names.size()) return frame;
  const auto link = std::find(kLinkNames.begin(), kLinkNames.end(), names[at]);
  if (link == kLinkNames.end()) return {};
  frame.link = kLinks[static_cast<size_t>(link - kLinkNames.begin())];
  if (!read_program(names, ++at, times, skills, frame.other) || at != names.size()) return {};
  return frame;
}

std::optional<size_t> link_place(const std::vector<int32_t>& symbols) {
  const int32_t first = symbol_named(kLinkNames.front());
  for (size_t at = 0; at < symbols.size(); ++at)
    if (symbols[at] >= first && symbols[at] < first + static_cast<int32_t>(kLinks.size()))
      return at;
  return {};
}

}  // namespace engram::speech
