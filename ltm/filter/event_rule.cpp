// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/event_rule.h"

#include <cmath>

#include "ltm/idf/element_visit.h"

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
  if (!entity && path.empty())
    return invalid_argument("event: has neither an entity nor a path, needs one or both");
  if (!std::isfinite(bound)) return invalid_argument("event: bound is {}, needs a number", bound);
  return {};
}

bool EventDetector::is_for(const MemoryId& entity, const MemoryId& own) const {
  return rule_.entity ? rule_.entity->matches(entity) : entity == own;
}

bool EventDetector::is_event(const Snapshot& snapshot) {
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
