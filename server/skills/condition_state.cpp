// SPDX-License-Identifier: Apache-2.0
#include "server/skills/condition_state.h"

#include <re2/re2.h>

#include <algorithm>
#include <cmath>

#include "ltm/idf/element_visit.h"
#include "ltm/idf/type_check.h"
#include "ltm/skills/skill_ids.h"
#include "ltm/skills/skill_types.h"

namespace engram::skills {

namespace {

template <typename Visit>
bool any_number(const idf::Data& value, const Visit& visit) {
  if (const auto number = value.as_number()) return visit(*number);
  const auto* array = value.get_if<idf::NdArray>();
  bool is_found = false;
  if (array != nullptr)
    idf::visit_element_type(array->type(), [&]<typename T>(T) {
      for (const T element : array->values<T>())
        if (!is_found && visit(static_cast<double>(element))) is_found = true;
    });
  return is_found;
}

bool is_equal(const idf::Data& found, const idf::Data& needed) {
  const auto number = found.as_number();
  const auto needed_number = needed.as_number();
  if (number && needed_number) return *number == *needed_number;
  const auto* text = found.get_if<std::string>();
  const auto* needed_text = needed.get_if<std::string>();
  return text != nullptr && needed_text != nullptr && *text == *needed_text;
}

/// Values are for people here: long ones are cut.
std::string short_text(const idf::Data& value) {
  constexpr size_t kMaxFound = 80;
  if (const auto* flag = value.get_if<bool>()) return *flag ? "true" : "false";
  if (const auto number = value.as_number()) return fmt::format("{}", *number);
  const auto* text = value.get_if<std::string>();
  if (text == nullptr) return idf::describe(value);
  return text->size() <= kMaxFound ? "'" + *text + "'"
                                   : fmt::format("a text of {} bytes", text->size());
}

/// The type of what the skill memory itself writes: outcomes are integers there, whose names tell.
std::optional<idf::Type> type_of_event(const ltm::MemoryId& entity) {
  const auto& names = entity.names();
  if (names[0] != kSkillMemory || names[1] != kEventSegment) return std::nullopt;
  return ::skill::Event::idf_type();
}

ltm::EventRule rule_of(const ConditionLeaf& leaf, const ltm::EntityPattern& pattern) {
  ltm::EventRule rule{.entity = pattern, .tells = leaf.tells};
  if (leaf.bound) {
    rule.path = leaf.path;
    rule.bound = *leaf.bound;
    rule.crossing = leaf.crossing;
  }
  return rule;
}

}  // namespace

Result<ConditionState> ConditionState::create(const Condition& condition) {
  ConditionState state;
  ENGRAM_RETURN_IF_ERROR(state.add(condition).status());
  return state;
}

Result<size_t> ConditionState::add(const Condition& condition) {
  Node node{.kind = condition.kind,
            .holds_for = condition.holds_for,
            .text = skills::to_string(condition),
            .leaf = condition.leaf};
  for (const Condition& part : condition.parts) {
    ENGRAM_ASSIGN_OR_RETURN(const size_t index, add(part));
    node.parts.push_back(index);
  }
  if (node.kind == Condition::Kind::kLeaf) {
    ENGRAM_ASSIGN_OR_RETURN(node.pattern, ltm::EntityPattern::parse(node.leaf.entity));
    if (!node.leaf.matches.empty()) {
      node.matches = std::make_shared<const re2::RE2>(node.leaf.matches, re2::RE2::Quiet);
      if (!node.matches->ok())
        return invalid_argument("condition '{}': {}", node.text, node.matches->error());
    }
    // Bounds are crossed, and outcomes are told, by the rules of recording.
    if (node.leaf.is_new && (node.leaf.bound || !node.leaf.tells.empty()))
      node.detector = std::make_unique<ltm::EventDetector>(rule_of(node.leaf, node.pattern));
  }
  nodes_.push_back(std::move(node));
  return nodes_.size() - 1;
}

std::vector<std::string> ConditionState::patterns() const {
  std::vector<std::string> patterns;
  for (const Node& node : nodes_)
    if (node.kind == Condition::Kind::kLeaf) patterns.push_back(node.leaf.entity);
  return patterns;
}

bool ConditionState::is_asked(const Node& node, const ltm::Instance& instance, std::string& found) {
  const ConditionLeaf& leaf = node.leaf;
  if (leaf.path.empty()) {
    found = "a snapshot";
    return true;
  }
  const idf::Data* value = instance.data.at(leaf.path);
  if (value == nullptr) {
    found = fmt::format("no '{}'", leaf.path);
    return false;
  }
  found = short_text(*value);
  if (leaf.equals) return is_equal(*value, *leaf.equals);
  if (leaf.bound)
    return any_number(*value, [&](double number) {
      if (std::isnan(number)) return false;
      return leaf.crossing == ltm::Crossing::kFalling ? number < *leaf.bound
                                                      : number >= *leaf.bound;
    });
  const auto* text = value->get_if<std::string>();
  return text != nullptr && node.matches && re2::RE2::FullMatch(*text, *node.matches);
}

void ConditionState::take(Node& node, const ltm::Snapshot& snapshot,
                          const std::optional<idf::Type>& type, bool is_new) {
  auto found = node.known.find(snapshot.entity);
  if (found == node.known.end()) {
    if (node.known.size() >= kMaxEntities) return;
    found = node.known.try_emplace(snapshot.entity).first;
  }
  Known& known = found->second;
  // The same snapshot may come twice: once as what is the case, and once as what came.
  if (known.time != Time{} && snapshot.time <= known.time) return;
  bool is_met = false;
  for (size_t i = 0; i < snapshot.instances.size() && !is_met; ++i) {
    is_met = is_asked(node, snapshot.instances[i], known.found);
    known.instance = snapshot.id().instance(static_cast<int32_t>(i));
  }
  if (node.detector) is_met = node.detector->is_event(snapshot, type);
  if (node.leaf.is_new) {
    if (is_met && is_new) node.pulse = known.instance;
    is_met = false;
  }
  if (is_met && !known.is_met) known.since = snapshot.time;
  known.is_met = is_met;
  known.time = snapshot.time;
}

bool ConditionState::take(const ltm::Snapshot& snapshot, bool is_new) {
  bool is_looked_at = false;
  for (Node& node : nodes_) {
    if (node.kind != Condition::Kind::kLeaf || !node.pattern.matches(snapshot.entity)) continue;
    take(node, snapshot, type_of_event(snapshot.entity), is_new);
    is_looked_at = true;
  }
  return is_looked_at;
}

void ConditionState::seed(const ltm::Snapshot& snapshot) {
  take(snapshot, false);
}

bool ConditionState::offer(const ltm::Snapshot& snapshot) {
  return take(snapshot, true);
}

const ConditionState::Known* ConditionState::met_by(const Node& node, Time now) {
  const Known* best = nullptr;
  for (const auto& [entity, known] : node.known) {
    if (!known.is_met) continue;
    if (node.leaf.max_age && now - known.time > *node.leaf.max_age) continue;
    // Of several entities the one counts that has been so for longest.
    if (best == nullptr || known.since < best->since) best = &known;
  }
  return best;
}

bool ConditionState::judge(size_t index, Time now, bool is_wanted) {
  Node& node = nodes_[index];
  bool is_so = false;
  std::optional<Time> since;
  if (node.kind == Condition::Kind::kLeaf) {
    const Known* known = met_by(node, now);
    is_so = known != nullptr || node.pulse;
    if (known != nullptr) since = std::min(known->since, now);
    // What is not to be so causes nothing.
    if (is_so && is_wanted) {
      const ltm::MemoryId& instance = node.pulse ? *node.pulse : known->instance;
      causes_.push_back(instance);
      if (!node.leaf.binds.empty()) bound_.insert_or_assign(node.leaf.binds, instance);
    }
  } else {
    const bool is_part_wanted = is_wanted != (node.kind == Condition::Kind::kNot);
    size_t met = 0;
    // All parts are judged, because each of them counts its own time.
    for (const size_t part : node.parts) met += judge(part, now, is_part_wanted) ? 1 : 0;
    if (node.kind == Condition::Kind::kAll) is_so = met == node.parts.size();
    if (node.kind == Condition::Kind::kAny) is_so = met > 0;
    if (node.kind == Condition::Kind::kNot) is_so = met == 0;
  }
  if (!is_so) {
    node.since.reset();
    return false;
  }
  if (!node.since) node.since = since.value_or(now);
  return now - *node.since >= node.holds_for;
}

bool ConditionState::is_met(Time now) {
  causes_.clear();
  bound_.clear();
  const bool is_met = judge(nodes_.size() - 1, now, true);
  for (Node& node : nodes_) node.pulse.reset();
  return is_met;
}

std::optional<Time> ConditionState::next_change(Time now) const {
  std::optional<Time> next;
  const auto consider = [&](Time time) {
    if (time > now && (!next || time < *next)) next = time;
  };
  for (const Node& node : nodes_) {
    if (node.since && node.holds_for > Duration(0)) consider(*node.since + node.holds_for);
    if (!node.leaf.max_age) continue;
    for (const auto& [entity, known] : node.known)
      if (known.is_met) consider(known.time + *node.leaf.max_age + Duration(1));
  }
  return next;
}

bool ConditionState::was_met(size_t index, Time now) const {
  const Node& node = nodes_[index];
  return node.since && now - *node.since >= node.holds_for;
}

void ConditionState::explain(size_t index, Time now, bool is_wanted,
                             std::vector<Unmet>& unmet) const {
  const Node& node = nodes_[index];
  if (was_met(index, now) == is_wanted) return;
  if (node.kind != Condition::Kind::kLeaf) {
    const size_t before = unmet.size();
    for (const size_t part : node.parts)
      explain(part, now, is_wanted != (node.kind == Condition::Kind::kNot), unmet);
    if (unmet.size() == before)
      unmet.push_back({node.text, fmt::format("it so for {}",
                                              engram::to_string(now - node.since.value_or(now)))});
    return;
  }
  Unmet one{(is_wanted ? "" : "not ") + node.text, ""};
  const Known* newest = nullptr;
  for (const auto& [entity, known] : node.known)
    if ((newest == nullptr || known.time > newest->time) &&
        (is_wanted || known.is_met || node.leaf.is_new))
      newest = &known;
  if (newest == nullptr) {
    one.found = node.known.empty() ? "no snapshot of such an entity yet" : "nothing new";
  } else {
    one.found = newest->found;
    if (node.leaf.max_age && newest->is_met && is_wanted)
      one.found += fmt::format(" {} ago", engram::to_string(now - newest->time));
    if (newest->is_met && node.since && is_wanted && node.holds_for > Duration(0))
      one.found += fmt::format(" for {}", engram::to_string(now - *node.since));
    one.where = newest->instance;
  }
  unmet.push_back(std::move(one));
}

std::vector<Unmet> ConditionState::unmet(Time now) const {
  std::vector<Unmet> unmet;
  explain(nodes_.size() - 1, now, true, unmet);
  return unmet;
}

}  // namespace engram::skills
