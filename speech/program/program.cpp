// SPDX-License-Identifier: Apache-2.0
#include "speech/program/program.h"

#include <algorithm>
#include <array>

namespace engram::speech {

namespace {

// Each in the order of its enumerators.
constexpr std::array<std::string_view, 7> kSourceNames{"executions", "words",  "plans", "refusals",
                                                       "drives",     "things", "robot"};
constexpr std::array<std::string_view, 14> kFilterNames{
    "skill", "thing", "place",   "hand",   "outcome", "speaker", "text",
    "kind",  "held",  "visible", "during", "at",      "after",   "before"};
constexpr std::array<std::string_view, 40> kStepNames{
    "first",     "last",         "nth",           "longest",     "shortest",  "previous",
    "next",      "first_seen",   "last_seen",     "count",       "exists",    "none",
    "how_many",  "events",       "when",          "ago",         "ended",     "span",
    "how_long",  "how_far",      "where",         "from",        "who",       "who_stopped",
    "which",     "said",         "why",           "reason",      "succeeded", "retried",
    "instead",   "instead_next", "instead_where", "instead_has", "holder",    "is_visible",
    "was_moved", "more_than",    "less_than",     "equals"};

template <typename Enum, size_t kCount>
std::optional<Enum> enumerator_named(const std::array<std::string_view, kCount>& names,
                                     std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return {};
  return static_cast<Enum>(found - names.begin());
}

}  // namespace

std::string_view name_of(ProgramSource source) {
  return kSourceNames.at(static_cast<size_t>(source));
}
std::string_view name_of(FilterKey key) {
  return kFilterNames.at(static_cast<size_t>(key));
}
std::string_view name_of(StepKind kind) {
  return kStepNames.at(static_cast<size_t>(kind));
}

std::optional<ProgramSource> source_named(std::string_view name) {
  return enumerator_named<ProgramSource>(kSourceNames, name);
}
std::optional<FilterKey> filter_named(std::string_view name) {
  return enumerator_named<FilterKey>(kFilterNames, name);
}
std::optional<StepKind> step_named(std::string_view name) {
  return enumerator_named<StepKind>(kStepNames, name);
}

bool operator==(const Argument& a, const Argument& b) {
  if (a.text != b.text || (a.program == nullptr) != (b.program == nullptr)) return false;
  return a.program == nullptr || *a.program == *b.program;
}

const Argument* Program::find(FilterKey key) const {
  for (const ProgramFilter& filter : filters)
    if (filter.key == key) return &filter.value;
  return nullptr;
}

bool Program::has_step(StepKind kind) const {
  return std::any_of(steps.begin(), steps.end(),
                     [kind](const ProgramStep& step) { return step.kind == kind; });
}

Program& Program::with(FilterKey key, std::string text) {
  filters.push_back({key, {std::move(text), nullptr}});
  return *this;
}

Program& Program::then(StepKind kind) {
  steps.push_back({kind, {}});
  return *this;
}

Program& Program::then(StepKind kind, std::string argument) {
  steps.push_back({kind, Argument{std::move(argument), nullptr}});
  return *this;
}

}  // namespace engram::speech
