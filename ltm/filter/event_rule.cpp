// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/event_rule.h"

#include <algorithm>
#include <cmath>

#include "ltm/idf/element_visit.h"
#include "ltm/memory/told_events.h"

namespace engram::ltm {

namespace {

/// Calls `function` with each number of `value`, a scalar or an array.
template <typename F>
void for_each_number(const idf::Data& value, F function) {
  if (const auto number = value.as_number()) return function(*number);
  const auto* array = value.get_if<idf::NdArray>();
  if (array == nullptr) return;
  idf::visit_element_type(array->type(), [&]<typename T>(T) {
    for (const T element : array->values<T>()) function(static_cast<double>(element));
  });
}

}  // namespace

Status EventRule::validate() const {
  if (!entity && path.empty() && tells.empty())
    return invalid_argument("event: has neither an entity nor a path nor tells, needs one of them");
  if (!path.empty() && !tells.empty())
    return invalid_argument("event: has 'path' and 'tells', needs one of them");
  if (!std::isfinite(bound)) return invalid_argument("event: bound is {}, needs a number", bound);
  return {};
}

bool EventDetector::is_for(const MemoryId& entity, const MemoryId& own) const {
  return rule_.entity ? rule_.entity->matches(entity) : entity == own;
}

bool EventDetector::tells(const Snapshot& snapshot, const std::optional<idf::Type>& type) {
  ToldEvents told;
  for (const Instance& instance : snapshot.instances) {
    const ToldEvents one = told_events(instance.data, type);
    if (told.outcome == ActionOutcome::kUnknown) told.outcome = one.outcome;
    told.is_speech = told.is_speech || one.is_speech;
    told.links = told.links * 31 + one.links;
  }
  const auto [before, is_first] = links_.try_emplace(snapshot.entity, told.links);
  const bool leads_elsewhere = !is_first && before->second != told.links;
  before->second = told.links;
  return std::ranges::any_of(rule_.tells, [&](Telling telling) {
    switch (telling) {
      case Telling::kFailure:
        return told.outcome == ActionOutcome::kFailure;
      case Telling::kStop:
        return told.outcome == ActionOutcome::kStop;
      case Telling::kSuccess:
        return told.outcome == ActionOutcome::kSuccess;
      case Telling::kSpeech:
        return told.is_speech;
      case Telling::kLinks:
        break;
    }
    return leads_elsewhere;
  });
}

bool EventDetector::is_event(const Snapshot& snapshot, const std::optional<idf::Type>& type) {
  if (!rule_.tells.empty()) return tells(snapshot, type);
  if (rule_.path.empty()) return true;
  std::vector<Side>& sides = sides_[snapshot.entity];
  size_t element = 0;
  bool is_crossed = false;
  for (const Instance& instance : snapshot.instances) {
    const idf::Data* value = instance.data.at(rule_.path);
    if (value == nullptr) continue;
    for_each_number(*value, [&](double number) {
      if (element == sides.size()) sides.push_back(Side::kUnknown);
      if (crosses(sides[element++], number)) is_crossed = true;
    });
  }
  sides.resize(element);
  return is_crossed;
}

bool EventDetector::crosses(Side& side, double value) const {
  if (std::isnan(value)) return false;
  const Side before = side;
  side = value >= rule_.bound ? Side::kAbove : Side::kBelow;
  if (side == before) return false;
  switch (rule_.crossing) {
    case Crossing::kRising:
      return side == Side::kAbove;
    case Crossing::kFalling:
      return side == Side::kBelow;
    case Crossing::kEither:
      break;
  }
  return before != Side::kUnknown;
}

}  // namespace engram::ltm
