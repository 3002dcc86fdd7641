// SPDX-License-Identifier: Apache-2.0
#include "speech/facts/known_facts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "ltm/filter/saturated_time.h"
#include "speech/facts/fact_members.h"
#include "speech/facts/facts_reader.h"

namespace engram::speech {

namespace {

/// What leads on from a value to why it is there.
constexpr std::array<std::string_view, 7> kCauseMembers{"plan",    "request", "cause",  "causes",
                                                        "command", "task",    "trigger"};
constexpr std::array<std::string_view, 4> kSayingMembers{"text", "goal", "reason", "skill"};
constexpr size_t kMaxCauses = 16;
/// The first look back, which doubles until something fits.
constexpr Duration kFirstLook = std::chrono::minutes(1);

template <typename Record>
const Record* record_at(const std::vector<Record>& records, const ltm::MemoryId& id) {
  if (!id.time()) return nullptr;
  auto found = std::lower_bound(records.begin(), records.end(), *id.time(),
                                [](const Record& record, Time time) { return record.time < time; });
  for (; found != records.end() && found->time == *id.time(); ++found)
    if (found->id.entity() == id.entity()) return &*found;
  return nullptr;
}

std::string said_by(const idf::Data& value) {
  for (const std::string_view member : kSayingMembers)
    if (std::string text = text_in(value, member); !text.empty()) return text;
  return {};
}

Duration twice(Duration duration) {
  return duration > Duration::max() / 2 ? Duration::max() : duration * 2;
}

}  // namespace

KnownFacts::KnownFacts(std::unique_ptr<FactsReader> reader) : reader_(std::move(reader)) {}
KnownFacts::~KnownFacts() = default;

Result<std::unique_ptr<KnownFacts>> KnownFacts::read(Memory& memory) {
  std::unique_ptr<KnownFacts> facts(new KnownFacts(std::make_unique<FactsReader>(memory)));
  ENGRAM_RETURN_IF_ERROR(facts->refresh());
  return facts;
}

Status KnownFacts::refresh() {
  return reader_->refresh();
}
Time KnownFacts::first_moment() const {
  return reader_->first_;
}
Time KnownFacts::last_moment() const {
  return reader_->last_;
}
const KnownWorld& KnownFacts::world() const {
  return reader_->world_;
}
const std::vector<Execution>& KnownFacts::executions() const {
  return reader_->executions_;
}
const std::vector<SpokenWords>& KnownFacts::words() const {
  return reader_->words_;
}
const std::vector<TaskPlan>& KnownFacts::plans() const {
  return reader_->plans_;
}
const std::vector<RefusedRequest>& KnownFacts::refusals() const {
  return reader_->refusals_;
}
const std::vector<DriveNote>& KnownFacts::drives() const {
  return reader_->drives_;
}
const std::vector<std::string>& KnownFacts::skills() const {
  return reader_->skills_;
}

const TaskPlan* KnownFacts::plan_at(const ltm::MemoryId& id) const {
  return record_at(reader_->plans_, id);
}

const SpokenWords* KnownFacts::words_at(const ltm::MemoryId& id) const {
  return record_at(reader_->words_, id);
}

Result<idf::Data> KnownFacts::value_at(const ltm::MemoryId& id) {
  if (!id.time()) return not_found("'{}' is no snapshot", id.printable());
  ENGRAM_ASSIGN_OR_RETURN(
      const ltm::QueryResult found,
      reader_->query(id.entity(), ltm::select::TimeRange{*id.time(), *id.time()}));
  const ltm::SnapshotResult* snapshot = found.find_snapshot(id.entity().at(*id.time()));
  const ltm::InstanceResult* instance =
      snapshot == nullptr ? nullptr : snapshot->find(id.index().value_or(0));
  if (instance == nullptr) return not_found("the memory has no '{}'", id.printable());
  return instance->data;
}

Result<std::vector<KnownFacts::Cause>> KnownFacts::causes_of(const Execution& execution) {
  const auto known = cause_lists_.find(execution.start_id);
  if (known != cause_lists_.end()) return known->second;
  ENGRAM_ASSIGN_OR_RETURN(std::vector<Cause> causes, read_causes(execution));
  // What is past does not change, but what is running may be told of further.
  if (cause_lists_.size() >= kMaxCauseLists) cause_lists_.clear();
  if (execution.ended && !causes.empty()) cause_lists_[execution.start_id] = causes;
  return causes;
}

Result<std::vector<KnownFacts::Cause>> KnownFacts::read_causes(const Execution& execution) {
  std::vector<Cause> causes;
  std::set<ltm::MemoryId> seen{execution.start_id};
  // The request names its cause, and an event may name the plan besides.
  std::vector<ltm::MemoryId> next;
  if (execution.plan) next.push_back(*execution.plan);
  if (execution.request) next.push_back(*execution.request);
  while (!next.empty() && causes.size() < kMaxCauses) {
    const ltm::MemoryId id = next.back();
    next.pop_back();
    if (!id.time() || !seen.insert(id).second) continue;
    const auto value = value_at(id);
    if (!value.ok() && value.status().code() == StatusCode::kNotFound) continue;
    ENGRAM_RETURN_IF_ERROR(value.status());
    causes.push_back({id, said_by(*value), text_in(*value, "speaker")});
    std::vector<ltm::MemoryId> leads;
    for (const std::string_view member : kCauseMembers)
      for (ltm::MemoryId& link : links_in(*value, member)) leads.push_back(std::move(link));
    next.insert(next.end(), leads.rbegin(), leads.rend());
  }
  return causes;
}

Result<std::optional<ThingState>> KnownFacts::thing_at(const ltm::MemoryId& entity, Time time) {
  ENGRAM_ASSIGN_OR_RETURN(
      const ltm::QueryResult found,
      reader_->query(entity, ltm::select::Before{.time = time, .is_inclusive = true}));
  const ltm::EntityResult* states = found.find_entity(entity);
  if (states == nullptr || states->snapshots.empty() || states->snapshots.back().instances.empty())
    return std::optional<ThingState>();
  const ltm::SnapshotResult& last = states->snapshots.back();
  return std::optional(
      read_thing_state(entity.at(last.time).instance(0), last.instances.front().data));
}

Result<std::vector<ThingState>> KnownFacts::things_at(Time time) {
  std::vector<ThingState> states;
  for (const ltm::MemoryId& segment : reader_->thing_segments_) {
    ENGRAM_ASSIGN_OR_RETURN(
        const ltm::QueryResult found,
        reader_->query(segment, ltm::select::Before{.time = time, .is_inclusive = true}));
    for (const ltm::EntityResult* entity : found.entities())
      for (const ltm::SnapshotResult& snapshot : entity->snapshots)
        if (!snapshot.instances.empty())
          states.push_back(read_thing_state(entity->id.at(snapshot.time).instance(0),
                                            snapshot.instances.front().data));
  }
  return states;
}

Result<std::optional<ThingState>> KnownFacts::last_state(const ltm::MemoryId& entity, Time from,
                                                         Time to, const StateTest& fits) {
  size_t states_read = 0;
  Duration look = kFirstLook;
  for (Time end = to; end >= from && states_read < kMaxStatesRead; look = twice(look)) {
    const Time begin = std::max(from, ltm::saturated_add(end, -look));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found,
                            reader_->query(entity, ltm::select::TimeRange{begin, end}));
    if (const ltm::EntityResult* states = found.find_entity(entity)) {
      states_read += states->snapshots.size();
      for (auto one = states->snapshots.rbegin(); one != states->snapshots.rend(); ++one) {
        if (one->instances.empty()) continue;
        ThingState state =
            read_thing_state(entity.at(one->time).instance(0), one->instances.front().data);
        if (fits(state)) return std::optional(std::move(state));
      }
    }
    if (begin == from || begin == Time::min()) break;
    end = begin - Duration(1);
  }
  return std::optional<ThingState>();
}

Result<std::optional<ThingState>> KnownFacts::first_state(const ltm::MemoryId& entity, Time from,
                                                          Time to, const StateTest& fits) {
  size_t states_read = 0;
  Duration look = kFirstLook;
  // What lies before the first snapshot is skipped.
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult first,
                          reader_->query(entity, ltm::select::IndexRange{0, 0}));
  const ltm::EntityResult* oldest = first.find_entity(entity);
  if (oldest == nullptr || oldest->snapshots.empty()) return std::optional<ThingState>();
  Time begin = std::max(from, oldest->snapshots.front().time);
  for (; begin <= to && states_read < kMaxStatesRead; look = twice(look)) {
    const Time end = to - begin < look ? to : begin + look;
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found,
                            reader_->query(entity, ltm::select::TimeRange{begin, end}));
    if (const ltm::EntityResult* states = found.find_entity(entity)) {
      states_read += states->snapshots.size();
      for (const ltm::SnapshotResult& one : states->snapshots) {
        if (one.instances.empty()) continue;
        ThingState state =
            read_thing_state(entity.at(one.time).instance(0), one.instances.front().data);
        if (fits(state)) return std::optional(std::move(state));
      }
    }
    begin = end + Duration(1);
  }
  return std::optional<ThingState>();
}

Result<std::optional<RobotState>> KnownFacts::robot_at(Time time) {
  std::optional<RobotState> newest;
  for (const ltm::MemoryId& robot : reader_->robots_) {
    ENGRAM_ASSIGN_OR_RETURN(
        const ltm::QueryResult found,
        reader_->query(robot, ltm::select::Before{.time = time, .is_inclusive = true}));
    const ltm::EntityResult* states = found.find_entity(robot);
    if (states == nullptr || states->snapshots.empty()) continue;
    const ltm::SnapshotResult& last = states->snapshots.back();
    if (last.instances.empty() || (newest && newest->time >= last.time)) continue;
    if (const auto spot = spot_in(last.instances.front().data, "pose_world_"))
      newest = RobotState{robot.at(last.time).instance(0), last.time, *spot};
  }
  return newest;
}

Result<std::optional<KnownFacts::Way>> KnownFacts::way_of_robot(Time from, Time to) {
  const auto known = ways_.find({from, to});
  if (known != ways_.end()) return std::optional(known->second);
  for (const ltm::MemoryId& robot : reader_->robots_) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found,
                            reader_->query(robot, ltm::select::TimeRange{from, to}));
    const ltm::EntityResult* states = found.find_entity(robot);
    if (states == nullptr || states->snapshots.size() < 2) continue;
    Way way;
    std::optional<Spot> before;
    for (const ltm::SnapshotResult& one : states->snapshots) {
      if (one.instances.empty()) continue;
      const auto spot = spot_in(one.instances.front().data, "pose_world_");
      if (spot && before) way.length_m += std::hypot(spot->x - before->x, spot->y - before->y);
      if (spot) before = spot;
    }
    way.ends = {robot.at(states->snapshots.front().time).instance(0),
                robot.at(states->snapshots.back().time).instance(0)};
    // What is past does not change. A memory of years has many drives, so some are forgotten.
    if (ways_.size() >= kMaxWays) ways_.clear();
    if (to < last_moment()) ways_[{from, to}] = way;
    return std::optional(std::move(way));
  }
  return std::optional<Way>();
}

}  // namespace engram::speech
