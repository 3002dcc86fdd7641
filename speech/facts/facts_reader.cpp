// SPDX-License-Identifier: Apache-2.0
#include "speech/facts/facts_reader.h"

#include <algorithm>
#include <array>

#include "ltm/core/ascii.h"
#include "speech/facts/answering.h"
#include "speech/facts/fact_members.h"

namespace engram::speech {

namespace {

/// A memory of more provider segments is no robot's, and each costs a query.
constexpr size_t kMaxSegments = 1000;

/// Entities of a segment at which somebody looks until one tells of something.
constexpr size_t kMaxLooks = 8;

/// Images live here (docs/design.md, section 2), and decoding one only to see what it is may take
/// a network.
constexpr std::string_view kImageMemory = "Vision";

bool is_rare(FactKind kind) {
  return kind == FactKind::kExecution || kind == FactKind::kRefusal || kind == FactKind::kWords ||
         kind == FactKind::kPlan || kind == FactKind::kDriveNote;
}

/// What things and places are called, and where places are.
bool is_of_world(FactKind kind) {
  return kind == FactKind::kThingClass || kind == FactKind::kSurface || kind == FactKind::kLocation;
}

/// The query of all entities below a prefix.
Result<ltm::Query> query_of(const ltm::MemoryId& prefix, const ltm::Selector& selector) {
  ENGRAM_RETURN_IF_ERROR(ltm::validate(selector));
  std::array<ltm::NamePattern, ltm::MemoryId::kNameLevels> names;
  for (size_t i = 0; i < prefix.names().size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(names.at(i), ltm::NamePattern::name(prefix.names()[i]));
  }
  return ltm::Query(names, selector);
}

void add_name(std::vector<std::string>& names, std::string name) {
  name = lower_ascii(name);
  if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
    names.push_back(std::move(name));
}

}  // namespace

Result<ltm::QueryResult> FactsReader::query(const ltm::MemoryId& prefix,
                                            const ltm::Selector& selector) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query asked, query_of(prefix, selector));
  auto found = memory_.query(asked);
  if (!found.ok() && found.status().code() == StatusCode::kNotFound) return ltm::QueryResult();
  return found;
}

Status FactsReader::refresh() {
  ENGRAM_RETURN_IF_ERROR(find_segments());
  for (auto& [id, segment] : segments_)
    if (is_rare(segment.kind)) ENGRAM_RETURN_IF_ERROR(read_segment(id, segment));
  // Copying a life of executions for each question would take longer than to answer it.
  if (!is_collected_) collect();
  is_collected_ = true;
  first_ = last_;
  const auto begins = [this](Time time) { first_ = std::min(first_, time); };
  if (!executions_.empty()) begins(executions_.front().started);
  if (!words_.empty()) begins(words_.front().time);
  if (!plans_.empty()) begins(plans_.front().time);
  return {};
}

/// Lists the entities without their data, and looks at values of a segment that is new until one
/// says what it tells of.
Status FactsReader::find_segments() {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query all, ltm::Query::parse("?ids .* @ latest"));
  auto found = memory_.query(all);
  if (!found.ok() && found.status().code() == StatusCode::kNotFound) return {};
  ENGRAM_RETURN_IF_ERROR(found.status());
  for (const ltm::EntityResult* entity : found->entities()) {
    if (entity->snapshots.empty()) continue;
    const Time last = entity->snapshots.back().time;
    last_ = std::max(last_, last);
    const ltm::MemoryId id = entity->id.parent();
    const auto known = segments_.find(id);
    if (known == segments_.end() && segments_.size() >= kMaxSegments) continue;
    Segment& segment = known == segments_.end() ? segments_[id] : known->second;
    const auto [of_entity, is_new] = segment.entities.try_emplace(entity->id);
    Extent& extent = of_entity->second;
    const bool is_unknown = segment.kind == FactKind::kNothing;
    // There may be several robots beside each other; else one entity tells what all of them are.
    if (is_new &&
        (is_unknown ? segment.entities.size() <= kMaxLooks : segment.kind == FactKind::kRobot))
      ENGRAM_RETURN_IF_ERROR(look_at(id, entity->id, segment));
    if (is_new || (is_of_world(segment.kind) && last > extent.last)) is_world_read_ = false;
    extent.last = std::max(extent.last, last);
  }
  return is_world_read_ ? Status() : read_world();
}

Status FactsReader::look_at(const ltm::MemoryId& segment, const ltm::MemoryId& entity,
                            Segment& found) {
  if (segment.names().front() == kImageMemory) return {};
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult latest, query(entity, ltm::select::Latest{}));
  const ltm::EntityResult* read = latest.find_entity(entity);
  if (read == nullptr || read->snapshots.empty() || read->snapshots.back().instances.empty())
    return {};
  const FactKind kind = fact_kind(read->snapshots.back().instances.front().data);
  if (kind == FactKind::kRobot) robots_.push_back(entity);
  if (found.kind != FactKind::kNothing) return {};
  found.kind = kind;
  if (kind == FactKind::kThing) thing_segments_.push_back(segment);
  return {};
}

Status FactsReader::read_world() {
  world_ = {};
  std::map<ltm::MemoryId, KnownThing> classes;
  ENGRAM_RETURN_IF_ERROR(read_classes(classes));
  ENGRAM_RETURN_IF_ERROR(read_things(classes));
  ENGRAM_RETURN_IF_ERROR(read_places());
  is_world_read_ = true;
  return {};
}

/// What kinds of things are called. A kind of which nothing was seen is known by its name, too.
Status FactsReader::read_classes(std::map<ltm::MemoryId, KnownThing>& classes) {
  for (const auto& [id, segment] : segments_) {
    if (segment.kind != FactKind::kThingClass) continue;
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found, query(id, ltm::select::Latest{}));
    for (const ltm::EntityResult* entity : found.entities()) {
      if (entity->snapshots.empty() || entity->snapshots.back().instances.empty()) continue;
      const ltm::SnapshotResult& snapshot = entity->snapshots.back();
      const idf::Data& value = snapshot.instances.front().data;
      KnownThing thing;
      thing.spoken = lower_ascii(text_in(value, "spoken_name"));
      thing.evidence = entity->id.at(snapshot.time).instance(0);
      add_name(thing.names, thing.spoken);
      add_name(thing.names, words_of_name(text_in(value, "name")));
      add_name(thing.names, words_of_name(entity->id.names().back()));
      classes[entity->id] = thing;
      world_.add_thing(std::move(thing));
    }
  }
  return {};
}

Status FactsReader::read_things(const std::map<ltm::MemoryId, KnownThing>& classes) {
  for (const ltm::MemoryId& segment : thing_segments_) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found, query(segment, ltm::select::Latest{}));
    for (const ltm::EntityResult* entity : found.entities()) {
      if (entity->snapshots.empty() || entity->snapshots.back().instances.empty()) continue;
      const ltm::SnapshotResult& snapshot = entity->snapshots.back();
      KnownThing thing;
      thing.entity = entity->id;
      thing.evidence = entity->id.at(snapshot.time).instance(0);
      const auto of_class = link_in(snapshot.instances.front().data, "object_class");
      const auto named = of_class ? classes.find(of_class->entity()) : classes.end();
      thing.spoken =
          named == classes.end() ? words_of_name(entity->id.names().back()) : named->second.spoken;
      add_name(thing.names, thing.spoken);
      if (named != classes.end())
        for (const std::string& name : named->second.names) add_name(thing.names, name);
      if (of_class) add_name(thing.names, words_of_name(of_class->names().back()));
      add_name(thing.names, words_of_name(entity->id.names().back()));
      world_.add_thing(std::move(thing));
    }
  }
  return {};
}

Status FactsReader::read_places() {
  for (const auto& [id, segment] : segments_) {
    if (segment.kind != FactKind::kSurface && segment.kind != FactKind::kLocation) continue;
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found, query(id, ltm::select::Latest{}));
    for (const ltm::EntityResult* entity : found.entities()) {
      if (entity->snapshots.empty() || entity->snapshots.back().instances.empty()) continue;
      const ltm::SnapshotResult& snapshot = entity->snapshots.back();
      const ltm::MemoryId instance = entity->id.at(snapshot.time).instance(0);
      const idf::Data& value = snapshot.instances.front().data;
      world_.add_place(segment.kind == FactKind::kSurface ? read_surface(instance, value)
                                                          : read_location(instance, value));
    }
  }
  return {};
}

Status FactsReader::read_segment(const ltm::MemoryId& id, Segment& segment) {
  Time last = Time::min();
  for (const auto& [entity, extent] : segment.entities) last = std::max(last, extent.last);
  if (!segment.is_read) ENGRAM_RETURN_IF_ERROR(read_below(id, Time::min(), last, segment.kind));
  for (auto& [entity, extent] : segment.entities) {
    // What one entity was told of may be earlier than what was read of another.
    if (segment.is_read && extent.last > extent.read_until)
      ENGRAM_RETURN_IF_ERROR(read_below(
          entity, extent.read_until == Time::min() ? Time::min() : extent.read_until + Duration(1),
          extent.last, segment.kind));
    extent.read_until = extent.last;
  }
  segment.is_read = true;
  return {};
}

Status FactsReader::read_below(const ltm::MemoryId& prefix, Time from, Time to, FactKind kind) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found,
                          query(prefix, ltm::select::TimeRange{from, to}));
  for (const ltm::EntityResult* entity : found.entities())
    for (const ltm::SnapshotResult& snapshot : entity->snapshots)
      if (!snapshot.instances.empty())
        take(kind, entity->id.at(snapshot.time).instance(0), snapshot.instances.front().data);
  return {};
}

void FactsReader::take(FactKind kind, const ltm::MemoryId& id, const idf::Data& value) {
  is_collected_ = false;
  if (kind == FactKind::kExecution) execution_table_.add(id, value, world_);
  if (kind == FactKind::kRefusal) refusals_.push_back(read_refusal(id, value));
  if (kind == FactKind::kWords) words_.push_back(read_words(id, value));
  if (kind == FactKind::kPlan) plans_.push_back(read_plan(id, value));
  if (kind == FactKind::kDriveNote) drives_.push_back(read_drive_note(id, value));
}

/// Brings the index into the order of time.
void FactsReader::collect() {
  executions_ = execution_table_.in_order();
  const auto is_of_answering = [](const auto& one) {
    return one.skill == kAnsweringSkill && one.provider == kAnsweringProvider;
  };
  std::erase_if(executions_, is_of_answering);
  std::erase_if(refusals_, is_of_answering);
  const auto by_time = [](auto& records) {
    std::sort(records.begin(), records.end(), [](const auto& a, const auto& b) {
      return a.time != b.time ? a.time < b.time : a.id < b.id;
    });
  };
  by_time(words_);
  by_time(plans_);
  by_time(refusals_);
  by_time(drives_);
  std::set<std::string> skills;
  for (const Execution& execution : executions_) skills.insert(execution.skill);
  for (const RefusedRequest& refusal : refusals_) skills.insert(refusal.skill);
  for (const TaskPlan& plan : plans_)
    for (const PlannedStep& step : plan.steps) skills.insert(step.skill);
  skills_.assign(skills.begin(), skills.end());
}

}  // namespace engram::speech
