// SPDX-License-Identifier: Apache-2.0
#include "speech/facts/read_records.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ltm/core/ascii.h"
#include "ltm/idf/json.h"
#include "speech/facts/fact_members.h"

namespace engram::speech {

namespace {

constexpr int64_t kStageEnded = 2;
/// Of more, nobody looks at the rest.
constexpr size_t kMaxReadFrom = 16;

/// A hand may be named, or be an entity of its own.
std::string hand_named(const std::string& text) {
  const auto link = link_named(text);
  return words_of_hand(link ? link->names().back() : text);
}

/// What an event is about: the entities and names that its members lead to.
class AboutReader {
 public:
  AboutReader(const KnownWorld& world, Execution& execution)
      : world_(world), execution_(execution) {}

  void read(const idf::Dict& dict) {
    for (const idf::DictEntry& member : dict) {
      if (const auto* text = member.value.get_if<std::string>()) take(member.key, *text);
      const auto* list = member.key == "inputs" ? member.value.get_if<idf::List>() : nullptr;
      if (list == nullptr) continue;
      for (const idf::Data& one : *list)
        if (const auto* text = one.get_if<std::string>()) take(member.key, *text);
    }
  }

 private:
  void take(const std::string& member, const std::string& text) {
    // The words of a reason may be the name of a thing.
    if (text.empty() || member == "reason" || member == "skill" || member == "result") return;
    if (member == "hand" && execution_.hand.empty()) execution_.hand = hand_named(text);
    if (const auto link = link_named(text)) {
      const ltm::MemoryId entity = link->entity();
      if (!execution_.thing && world_.thing(entity) != nullptr) execution_.thing = entity;
      if (!execution_.place && world_.place(entity) != nullptr) execution_.place = entity;
      return;
    }
    if (member == "hand" || text.size() > 100) return;
    if (!execution_.place)
      if (const auto places = world_.places_called(words_of_name(text)); !places.empty())
        execution_.place = places.front();
    if (!execution_.thing)
      if (const auto things = world_.things_called(words_of_name(text)); !things.empty())
        execution_.thing = things.front();
  }

  const KnownWorld& world_;
  Execution& execution_;
};

void read_about(const idf::Data& value, const KnownWorld& world, Execution& execution) {
  AboutReader reader(world, execution);
  const auto* dict = value.get_if<idf::Dict>();
  if (dict != nullptr) reader.read(*dict);
  const std::string text = text_in(value, "parameters");
  if (text.empty()) return;
  const auto parameters = idf::from_json_text(text);
  const auto* named = parameters.ok() ? parameters->get_if<idf::Dict>() : nullptr;
  if (named != nullptr) reader.read(*named);
}

using MemberFlags = std::array<bool, static_cast<size_t>(ToldMember::kCount)>;

MemberFlags told_members(const Execution& execution) {
  return {!execution.hand.empty(),     execution.thing.has_value(),
          execution.place.has_value(), execution.request.has_value(),
          execution.plan.has_value(),  execution.thing_before.has_value()};
}

void set_if_missing(std::optional<ltm::MemoryId>& member, std::optional<ltm::MemoryId> found) {
  if (!member) member = std::move(found);
}

KnownPlace named_place(const ltm::MemoryId& id, const idf::Data& value) {
  KnownPlace place;
  place.entity = id.entity();
  place.evidence = id;
  const std::string name = text_in(value, "name");
  place.spoken = words_of_name(name.empty() ? id.names().back() : name);
  place.names = {place.spoken};
  if (const std::string words = words_of_name(id.names().back()); words != place.spoken)
    place.names.push_back(words);
  place.spot = spot_in(value, "pose_world_");
  return place;
}

}  // namespace

std::string provider_of(const std::string& name) {
  const size_t slash = name.rfind('/');
  return slash == std::string::npos ? std::string() : name.substr(0, slash);
}

std::string skill_of(const std::string& name) {
  const size_t slash = name.rfind('/');
  return slash == std::string::npos ? name : name.substr(slash + 1);
}

void ExecutionTable::add(const ltm::MemoryId& id, const idf::Data& value, const KnownWorld& world) {
  const Time started = time_in(value, "started").value_or(*id.time());
  const auto [found, is_new] = table_.try_emplace({started, id.entity()});
  Execution& execution = found->second;
  is_sorted_ = false;
  if (is_new) {
    const std::string name = text_in(value, "skill");
    execution.provider = provider_of(name);
    execution.skill = skill_of(name);
    execution.started = started;
    execution.start_id = id;
  }
  if (*id.time() < *execution.start_id.time()) execution.start_id = id;
  const MemberFlags before = told_members(execution);
  read_about(value, world, execution);
  set_if_missing(execution.request, link_in(value, "request"));
  set_if_missing(execution.plan, link_in(value, "plan"));
  for (ltm::MemoryId& link : links_in(value, "read_from"))
    if (std::find(execution.read_from.begin(), execution.read_from.end(), link) ==
            execution.read_from.end() &&
        execution.read_from.size() < kMaxReadFrom)
      execution.read_from.push_back(std::move(link));
  set_if_missing(execution.thing_before, link_in(value, "object_before"));
  const MemberFlags known = told_members(execution);
  for (size_t i = 0; i < known.size(); ++i)
    if (known.at(i) && !before.at(i)) execution.told_at.at(i) = *id.time();
  if (auto after = link_in(value, "object_after")) execution.thing_after = std::move(after);
  const ltm::ActionOutcome outcome = outcome_member(value);
  // Events of before there were stages tell by their outcome alone that they are the last one.
  const auto stage = integer_in(value, "stage");
  if (stage ? *stage != kStageEnded : outcome == ltm::ActionOutcome::kRunning) return;
  execution.outcome = outcome;
  execution.ended = std::max(started, time_in(value, "ended").value_or(*id.time()));
  execution.end_id = id;
  execution.reason = text_in(value, "reason");
  execution.stopped_by = links_in(value, "stopped_by");
}

const std::vector<Execution>& ExecutionTable::in_order() {
  if (is_sorted_) return sorted_;
  sorted_.clear();
  sorted_.reserve(table_.size());
  for (const auto& [key, execution] : table_) sorted_.push_back(execution);
  // What has no end, because the recording ended before it did, does not go on for ever.
  std::map<std::pair<ltm::MemoryId, std::string>, Time> next;
  for (auto one = sorted_.rbegin(); one != sorted_.rend(); ++one) {
    const auto [later, is_last] =
        next.try_emplace({one->start_id.entity(), one->hand}, one->started);
    if (!is_last && !one->ended) one->over_by = later->second;
    later->second = one->started;
  }
  is_sorted_ = true;
  return sorted_;
}

SpokenWords read_words(const ltm::MemoryId& id, const idf::Data& value) {
  return {id, *id.time(), text_in(value, "speaker"), text_in(value, "text")};
}

TaskPlan read_plan(const ltm::MemoryId& id, const idf::Data& value) {
  TaskPlan plan{id, *id.time(), text_in(value, "goal"), link_in(value, "command"), {}};
  const idf::Data* steps = value.at("steps");
  const auto* list = steps == nullptr ? nullptr : steps->get_if<idf::List>();
  if (list == nullptr) return plan;
  for (const idf::Data& step : *list) {
    PlannedStep read{skill_of(text_in(step, "skill")), link_in(step, "object"),
                     link_in(step, "surface")};
    if (read.thing) read.thing = read.thing->entity();
    if (read.place) read.place = read.place->entity();
    plan.steps.push_back(std::move(read));
  }
  return plan;
}

RefusedRequest read_refusal(const ltm::MemoryId& id, const idf::Data& value) {
  const std::string name = text_in(value, "skill");
  return {id,
          *id.time(),
          provider_of(name),
          skill_of(name),
          text_in(value, "reason"),
          link_in(value, "request")};
}

DriveNote read_drive_note(const ltm::MemoryId& id, const idf::Data& value) {
  constexpr std::array<const char*, 8> kKinds{"started", "replanned", "blocked", "arrived",
                                              "refused", "trapped",   "stopped", "failed"};
  DriveNote note{id,
                 *id.time(),
                 {},
                 text_in(value, "goal"),
                 text_in(value, "reason"),
                 link_in(value, "request"),
                 links_in(value, "blocked_by")};
  const auto kind = integer_in(value, "kind");
  if (kind && *kind >= 0 && *kind < static_cast<int64_t>(kKinds.size()))
    note.kind = kKinds.at(static_cast<size_t>(*kind));
  return note;
}

ThingState read_thing_state(const ltm::MemoryId& id, const idf::Data& value) {
  ThingState state{
      id, *id.time(), spot_in(value, "pose_world_"), {}, hand_named(text_in(value, "held_by"))};
  if (const auto visible = integer_in(value, "is_visible")) state.is_visible = *visible != 0;
  state.colour = lower_ascii(text_in(value, "colour"));
  state.read_from = links_in(value, "read_from");
  if (state.read_from.size() > kMaxReadFrom) state.read_from.resize(kMaxReadFrom, id);
  return state;
}

KnownPlace read_surface(const ltm::MemoryId& id, const idf::Data& value) {
  KnownPlace place = named_place(id, value);
  const auto number = [&value](const char* member) {
    const idf::Data* found = value.at(member);
    const double length = found == nullptr ? 0.0 : found->as_number().value_or(0);
    return std::isfinite(length) ? std::max(length, 0.0) : 0.0;
  };
  place.depth_m = number("depth");
  place.width_m = number("width");
  return place;
}

KnownPlace read_location(const ltm::MemoryId& id, const idf::Data& value) {
  KnownPlace place = named_place(id, value);
  const idf::Data* aliases = value.at("aliases");
  const auto* list = aliases == nullptr ? nullptr : aliases->get_if<idf::List>();
  if (list == nullptr) return place;
  for (const idf::Data& alias : *list)
    if (const auto* text = alias.get_if<std::string>(); text != nullptr && !text->empty())
      place.names.push_back(words_of_name(*text));
  return place;
}

}  // namespace engram::speech
