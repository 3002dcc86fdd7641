// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <initializer_list>

#include "ltm/core/printable.h"
#include "speech/program/period.h"
#include "speech/program/program.h"

namespace engram::speech {

namespace {

using Source = ProgramSource;
using Key = FilterKey;
using Kind = StepKind;

bool is_one_of(auto value, std::initializer_list<decltype(value)> values) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

bool fits_source(Key key, Source source) {
  switch (key) {
    case Key::kSkill:
      return is_one_of(source, {Source::kExecutions, Source::kRefusals});
    case Key::kThing:
    case Key::kPlace:
      return is_one_of(source, {Source::kExecutions, Source::kPlans, Source::kThings}) ||
             (key == Key::kPlace && source == Source::kRobot);
    case Key::kHand:
      return is_one_of(source, {Source::kExecutions, Source::kThings});
    case Key::kOutcome:
      return source == Source::kExecutions;
    case Key::kSpeaker:
      return is_one_of(source, {Source::kExecutions, Source::kWords, Source::kPlans});
    case Key::kText:
      return !is_one_of(source, {Source::kThings, Source::kRobot});
    case Key::kKind:
      return source == Source::kDrives;
    case Key::kIsHeld:
    case Key::kVisible:
      return source == Source::kThings;
    case Key::kAt:
      return true;
    case Key::kDuring:
      return source != Source::kRobot;
    case Key::kAfter:
    case Key::kBefore:
      return source != Source::kRobot;
  }
  return false;
}

bool is_time_filter(Key key) {
  return is_one_of(key, {Key::kDuring, Key::kAt, Key::kAfter, Key::kBefore});
}

Status check_choice(Key key, const std::string& text, std::initializer_list<const char*> choices) {
  for (const char* choice : choices)
    if (text == choice) return {};
  return invalid_argument("program: filter {} is '{}', needs {}", name_of(key), printable(text),
                          fmt::join(choices, ", "));
}

Status check_text(const ProgramFilter& filter) {
  const std::string& text = filter.value.text;
  if (filter.key == Key::kOutcome)
    return check_choice(filter.key, text,
                        {"running", "success", "failure", "stop", "lost", "problem"});
  if (is_one_of(filter.key, {Key::kIsHeld, Key::kVisible}))
    return check_choice(filter.key, text, {"yes", "no"});
  // Any moment will do to see whether it is a time at all.
  if (is_time_filter(filter.key)) return resolve_period(text, Time{}, DayZone::kUtc).status();
  return {};
}

/// What a program has made after some of its steps.
enum class Made { kMany, kOne, kState, kFlag, kNumber, kMoment, kNames, kOther };

bool is_value(Made made) {
  return !is_one_of(made, {Made::kMany, Made::kOne, Made::kState});
}

/// The steps that make a value, what they make it of, and which value.
struct ValueStep {
  Kind kind;
  std::initializer_list<Source> sources;
  Made makes;
};

std::optional<Made> made_by(Kind kind, Source source) {
  constexpr auto kDone = Source::kExecutions;
  static const ValueStep kValueSteps[] = {
      {Kind::kCount,
       {kDone, Source::kWords, Source::kPlans, Source::kRefusals, Source::kDrives, Source::kThings},
       Made::kNumber},
      {Kind::kExists,
       {kDone, Source::kWords, Source::kPlans, Source::kRefusals, Source::kDrives, Source::kThings,
        Source::kRobot},
       Made::kFlag},
      {Kind::kNone,
       {kDone, Source::kWords, Source::kPlans, Source::kRefusals, Source::kDrives, Source::kThings},
       Made::kFlag},
      {Kind::kHowMany, {kDone, Source::kWords, Source::kThings, Source::kPlans}, Made::kNumber},
      {Kind::kAgo,
       {kDone, Source::kWords, Source::kPlans, Source::kRefusals, Source::kDrives, Source::kThings},
       Made::kNumber},
      {Kind::kInsteadNext, {kDone}, Made::kOther},
      {Kind::kInsteadWhere, {kDone}, Made::kOther},
      {Kind::kInsteadHas, {kDone}, Made::kFlag},
      {Kind::kEvents, {kDone}, Made::kOther},
      {Kind::kWhen,
       {kDone, Source::kWords, Source::kPlans, Source::kRefusals, Source::kDrives, Source::kThings},
       Made::kMoment},
      {Kind::kEnded, {kDone}, Made::kMoment},
      {Kind::kSpan, {kDone}, Made::kOther},
      {Kind::kHowLong, {kDone}, Made::kNumber},
      {Kind::kHowFar, {kDone}, Made::kNumber},
      {Kind::kWhere, {kDone, Source::kThings, Source::kRobot}, Made::kOther},
      {Kind::kFrom, {kDone}, Made::kOther},
      {Kind::kWho, {kDone, Source::kWords, Source::kPlans}, Made::kOther},
      {Kind::kWhoStopped, {kDone}, Made::kOther},
      {Kind::kWhich, {kDone, Source::kWords, Source::kThings, Source::kPlans}, Made::kNames},
      {Kind::kSaid, {kDone, Source::kWords, Source::kPlans}, Made::kOther},
      {Kind::kWhy, {kDone}, Made::kOther},
      {Kind::kReason, {kDone, Source::kRefusals, Source::kDrives}, Made::kOther},
      {Kind::kSucceeded, {kDone}, Made::kFlag},
      {Kind::kRetried, {kDone}, Made::kFlag},
      {Kind::kInstead, {kDone}, Made::kOther},
      {Kind::kHolder, {Source::kThings}, Made::kOther},
      {Kind::kIsVisible, {Source::kThings}, Made::kFlag},
      {Kind::kWasMoved, {Source::kThings}, Made::kFlag}};
  for (const ValueStep& step : kValueSteps)
    if (step.kind == kind && is_one_of(source, step.sources)) return step.makes;
  return {};
}

bool is_comparison(Kind kind) {
  return is_one_of(kind, {Kind::kMoreThan, Kind::kLessThan, Kind::kEquals});
}

class ProgramValidator {
 public:
  explicit ProgramValidator(const Program& program) : program_(program) {}

  Result<Made> made(int depth) {
    if (depth >= Program::kMaxDepth)
      return invalid_argument("program: needs at most {} programs in each other",
                              Program::kMaxDepth);
    if (program_.filters.size() > Program::kMaxParts || program_.steps.size() > Program::kMaxParts)
      return invalid_argument("program: needs at most {} filters and steps", Program::kMaxParts);
    for (const ProgramFilter& filter : program_.filters)
      ENGRAM_RETURN_IF_ERROR(check_filter(filter, depth));
    Made made = Made::kMany;
    for (const ProgramStep& step : program_.steps) {
      ENGRAM_ASSIGN_OR_RETURN(made, made_after(made, step, depth));
    }
    return made;
  }

 private:
  Status check_filter(const ProgramFilter& filter, int depth) {
    if (!fits_source(filter.key, program_.source))
      return invalid_argument("program: {} have no filter {}", name_of(program_.source),
                              name_of(filter.key));
    if (std::count_if(program_.filters.begin(), program_.filters.end(),
                      [&](const ProgramFilter& other) { return other.key == filter.key; }) > 1)
      return invalid_argument("program: filter {} is there twice", name_of(filter.key));
    if (filter.value.program == nullptr) return check_text(filter);
    ENGRAM_ASSIGN_OR_RETURN(const Made inner,
                            ProgramValidator(*filter.value.program).made(depth + 1));
    if (!is_time_filter(filter.key) || inner != Made::kMoment)
      return invalid_argument(
          "program: filter {} has a program, needs {}", name_of(filter.key),
          is_time_filter(filter.key) ? "one that ends in when or ended" : "a text");
    return {};
  }

  Result<Made> made_after(Made made, const ProgramStep& step, int depth) {
    const std::string_view name = name_of(step.kind);
    if (is_comparison(step.kind)) return made_by_comparison(made, step, depth);
    if (is_value(made)) return invalid_argument("program: {} needs records before it", name);
    ENGRAM_RETURN_IF_ERROR(check_argument(step));
    if (is_one_of(step.kind, {Kind::kFirst, Kind::kLast, Kind::kNth}) &&
        program_.source != Source::kRobot)
      return Made::kOne;
    if (is_one_of(step.kind, {Kind::kLongest, Kind::kShortest, Kind::kPrevious, Kind::kNext}) &&
        program_.source == Source::kExecutions)
      return Made::kOne;
    if (is_one_of(step.kind, {Kind::kFirstSeen, Kind::kLastSeen}) &&
        program_.source == Source::kThings)
      return Made::kState;
    const auto value = made_by(step.kind, program_.source);
    if (!value)
      return invalid_argument("program: {} have no step {}", name_of(program_.source), name);
    return *value;
  }

  [[nodiscard]] Status check_argument(const ProgramStep& step) const {
    const std::string_view name = name_of(step.kind);
    const bool needs =
        is_one_of(step.kind, {Kind::kNth, Kind::kWhich, Kind::kHowMany, Kind::kInsteadHas});
    if (needs != step.argument.has_value() || (needs && step.argument->program != nullptr))
      return invalid_argument("program: step {} needs {}", name,
                              needs ? "a value, as nth=2 or which=thing" : "no value");
    if (step.kind == Kind::kNth) {
      const std::string& text = step.argument->text;
      if (text.empty() || text.size() > 4 ||
          text.find_first_not_of("0123456789") != std::string::npos || std::stoi(text) == 0)
        return invalid_argument("program: step nth is '{}', needs a number from 1 to 9999",
                                printable(text));
    }
    return is_one_of(step.kind, {Kind::kWhich, Kind::kHowMany}) ? check_what(step) : Status();
  }

  [[nodiscard]] Status check_what(const ProgramStep& step) const {
    std::vector<std::string_view> choices{"thing", "hand", "skill", "place", "person"};
    if (program_.source == Source::kThings) choices.emplace_back("colour");
    if (program_.source == Source::kPlans && step.kind == Kind::kHowMany)
      choices.emplace_back("step");
    const std::string& text = step.argument->text;
    if (std::find(choices.begin(), choices.end(), text) != choices.end()) return {};
    return invalid_argument("program: step {} is '{}', needs one of {}", name_of(step.kind),
                            printable(text), fmt::join(choices, ", "));
  }

  static Result<Made> made_by_comparison(Made made, const ProgramStep& step, int depth) {
    const std::string_view name = name_of(step.kind);
    const bool has_order = is_one_of(made, {Made::kNumber, Made::kMoment});
    if (!has_order && (made != Made::kNames || step.kind != Kind::kEquals))
      return invalid_argument(
          "program: {} needs {} before it", name,
          step.kind == Kind::kEquals ? "a number, a time or names" : "a number or a time");
    if (!step.argument || step.argument->program == nullptr)
      return invalid_argument("program: step {} needs a program in parentheses", name);
    ENGRAM_ASSIGN_OR_RETURN(const Made other,
                            ProgramValidator(*step.argument->program).made(depth + 1));
    if (other != made)
      return invalid_argument("program: {} needs the same kind of value on both sides", name);
    return Made::kFlag;
  }

  const Program& program_;
};

}  // namespace

Status Program::validate() const {
  ENGRAM_ASSIGN_OR_RETURN(const Made made, ProgramValidator(*this).made(0));
  if (!is_value(made))
    return invalid_argument(
        "program: '{}' ends without a value, needs a step as count, when or why",
        printable(to_string()));
  return {};
}

}  // namespace engram::speech
