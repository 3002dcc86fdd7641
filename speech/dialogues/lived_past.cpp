// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/lived_past.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "ltm/typed/convert.h"
#include "ltm/typed/convert_eigen.h"
#include "ltm/typed/pose.h"

namespace engram::speech::dialogues {

namespace {

constexpr int64_t kMaxSeed = int64_t{1} << 62;
constexpr double kMaxRecording_s = 366.0 * 24 * 3600;
/// Times end in 2262, so that there is room for a recording, and for the day after it.
constexpr Time kMaxTime{std::chrono::seconds(7'258'118'400)};
constexpr double kMaxStandHeight_m = 0.3;
/// How far from the edge of a place something must stand: nobody then disputes that it is there.
constexpr double kClearlyOn_m = 0.02;
constexpr Duration kMaxSightAge = std::chrono::milliseconds(500);

/// The members of one value, read with errors that name the value.
class LivedValue {
 public:
  LivedValue(const ltm::MemoryId& id, const idf::Data& data) : id_(id), data_(data) {}

  [[nodiscard]] const ltm::MemoryId& id() const { return id_; }
  [[nodiscard]] Time time() const { return *id_.time(); }

  Result<std::string> text(std::string_view member) const {
    const auto* found = find<std::string>(member);
    if (found == nullptr) return wrong(member, "a text");
    return *found;
  }
  Result<double> number(std::string_view member) const {
    const idf::Data* found = data_.at(member);
    const auto number = found == nullptr ? std::nullopt : found->as_number();
    if (!number) return wrong(member, "a number");
    return *number;
  }
  /// A number without a fraction, from 0 to `max`.
  Result<int64_t> integer(std::string_view member, int64_t max) const {
    ENGRAM_ASSIGN_OR_RETURN(const double found, number(member));
    if (!(found >= 0 && found <= static_cast<double>(max)) || found != std::floor(found))
      return wrong(member, fmt::format("an integer of 0 to {}", max));
    return static_cast<int64_t>(found);
  }
  /// Nothing if the member is missing or empty.
  [[nodiscard]] std::optional<ltm::MemoryId> link(std::string_view member) const {
    const auto* found = find<std::string>(member);
    return found == nullptr ? std::nullopt : id_in(*found);
  }
  /// A link to an instance, which has a time.
  Result<ltm::MemoryId> instance(std::string_view member) const {
    auto found = link(member);
    if (!found || !found->time()) return wrong(member, "a link to an instance");
    return *std::move(found);
  }
  /// Links to instances; none if the member is missing.
  Result<std::vector<ltm::MemoryId>> instances(std::string_view member) const {
    std::vector<ltm::MemoryId> ids;
    const auto* list = find<idf::List>(member);
    if (list == nullptr) return ids;
    for (const idf::Data& one : *list) {
      const auto* text = one.get_if<std::string>();
      auto id = text == nullptr ? std::nullopt : id_in(*text);
      if (!id || !id->time()) return wrong(member, "a list of links to instances");
      ids.push_back(*std::move(id));
    }
    return ids;
  }
  Result<Eigen::Isometry3d> pose(std::string_view member) const {
    static const idf::Type kType = idf::Type::pose(idf::ElementType::kFloat64);
    const idf::Data* found = data_.at(member);
    typed::Pose<double> pose;
    if (found == nullptr || !typed::read(*found, kType, pose)) return wrong(member, "a pose");
    return pose.isometry();
  }
  [[nodiscard]] Status wrong(std::string_view member, std::string_view needed) const {
    const idf::Data* found = data_.at(member);
    return invalid_argument("'{}': member '{}' is {}, needs {}", id_.printable(), member,
                            found == nullptr ? "missing" : found->kind_name(), needed);
  }
  template <typename T>
  [[nodiscard]] const T* find(std::string_view member) const {
    const idf::Data* found = data_.at(member);
    return found == nullptr ? nullptr : found->get_if<T>();
  }

 private:
  static std::optional<ltm::MemoryId> id_in(const std::string& text) {
    if (text.empty()) return {};
    auto id = ltm::MemoryId::parse(text);
    return id.ok() && id->has_entity() ? std::optional(*std::move(id)) : std::nullopt;
  }

  const ltm::MemoryId& id_;
  const idf::Data& data_;
};

using VisitValue = std::function<Status(const LivedValue&)>;

/// Visits every first instance of what a query finds; nothing if there is no such entity.
Status visit_all(Memory& memory, std::string_view names, const VisitValue& visit) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query,
                          ltm::Query::parse(fmt::format("{} @ all#0", names)));
  const Status status = memory.query_parts(query, [&](ltm::QueryResult part) -> Status {
    for (const ltm::EntityResult* entity : part.entities())
      for (const ltm::SnapshotResult& snapshot : entity->snapshots)
        for (const ltm::InstanceResult& instance : snapshot.instances) {
          const ltm::MemoryId id = entity->id.at(snapshot.time).instance(instance.index);
          ENGRAM_RETURN_IF_ERROR(visit(LivedValue(id, instance.data)));
        }
    return {};
  });
  return status.code() == StatusCode::kNotFound ? Status() : status;
}

/// Reads one kind of values after the other.
class PastReader {
 public:
  PastReader(Memory& memory, LivedPast& past) : memory_(memory), past_(past) {}

  Status read() {
    ENGRAM_RETURN_IF_ERROR(read_recordings());
    ENGRAM_RETURN_IF_ERROR(read_names());
    ENGRAM_RETURN_IF_ERROR(read_sights());
    ENGRAM_RETURN_IF_ERROR(read_words_and_plans());
    ENGRAM_RETURN_IF_ERROR(read_actions());
    ENGRAM_RETURN_IF_ERROR(read_stands());
    sort_by_time();
    return {};
  }

 private:
  Status read_recordings() {
    ENGRAM_RETURN_IF_ERROR(
        visit_all(memory_, "Simulation/Recording", [&](const LivedValue& value) -> Status {
          ENGRAM_ASSIGN_OR_RETURN(const double seconds, value.number("seconds"));
          ENGRAM_ASSIGN_OR_RETURN(const int64_t seed, value.integer("seed", kMaxSeed));
          if (!(seconds >= 1 && seconds <= kMaxRecording_s))
            return value.wrong("seconds", fmt::format("1 to {} s", kMaxRecording_s));
          if (value.time() < Time() || value.time() > kMaxTime)
            return invalid_argument("'{}': needs a time of 1970 to 2200", value.id().printable());
          // The last sample comes 10 ms before the end.
          ENGRAM_ASSIGN_OR_RETURN(const Duration length, duration_from_seconds(seconds - 0.01));
          if (past_.recordings.empty()) past_.seed = seed;
          past_.recordings.emplace_back(value.time(), value.time() + length);
          return {};
        }));
    if (past_.recordings.empty())
      return not_found("dialogues: the memory has no recording of a kitchen");
    std::sort(past_.recordings.begin(), past_.recordings.end());
    return {};
  }

  Status read_names() {
    std::set<std::string> known;
    ENGRAM_RETURN_IF_ERROR(
        visit_all(memory_, "Objects/Classes", [&](const LivedValue& value) -> Status {
          ENGRAM_ASSIGN_OR_RETURN(spoken_[value.id().entity()], value.text("spoken_name"));
          known.insert(spoken_[value.id().entity()]);
          return {};
        }));
    past_.known_things.assign(known.begin(), known.end());
    return visit_all(memory_, "Objects/Surfaces", [&](const LivedValue& value) -> Status {
      ENGRAM_ASSIGN_OR_RETURN(const std::string name, value.text("name"));
      LivedPlace& place = past_.places[name];
      place.id = value.id();
      ENGRAM_ASSIGN_OR_RETURN(place.pose, value.pose("pose_world_surface"));
      ENGRAM_ASSIGN_OR_RETURN(place.depth_m, value.number("depth"));
      ENGRAM_ASSIGN_OR_RETURN(place.width_m, value.number("width"));
      spoken_[value.id().entity()] = name;
      return {};
    });
  }

  Status read_sights() {
    return visit_all(memory_, "Objects/Instances", [&](const LivedValue& value) -> Status {
      LivedSight sight{.id = value.id(), .time = value.time()};
      const auto type = value.link("object_class");
      const std::string name = spoken(type);
      if (name.empty()) return {};
      spoken_[value.id().entity()] = name;
      ENGRAM_ASSIGN_OR_RETURN(const Eigen::Isometry3d pose, value.pose("pose_world_object"));
      sight.at = pose.translation();
      ENGRAM_ASSIGN_OR_RETURN(sight.held_by, value.text("held_by"));
      if (const auto* colour = value.find<std::string>("colour")) sight.colour = *colour;
      const bool* visible = value.find<bool>("is_visible");
      sight.is_visible = visible != nullptr && *visible;
      past_.sights[name].push_back(std::move(sight));
      return {};
    });
  }

  Status read_words_and_plans() {
    ENGRAM_RETURN_IF_ERROR(
        visit_all(memory_, "Speech/Commands", [&](const LivedValue& value) -> Status {
          LivedWords words{.id = value.id(), .time = value.time()};
          ENGRAM_ASSIGN_OR_RETURN(words.speaker, value.text("speaker"));
          ENGRAM_ASSIGN_OR_RETURN(words.text, value.text("text"));
          past_.words.push_back(std::move(words));
          return {};
        }));
    return visit_all(memory_, "Tasks/Plans", [&](const LivedValue& value) -> Status {
      LivedPlan plan{
          .id = value.id(), .time = value.time(), .command = value.link("command"), .steps = {}};
      if (const auto* steps = value.find<idf::List>("steps"); steps != nullptr)
        for (const idf::Data& data : *steps) {
          const LivedValue step(value.id(), data);
          LivedStep& added = plan.steps.emplace_back();
          ENGRAM_ASSIGN_OR_RETURN(added.skill, step.text("skill"));
          added.thing = spoken(step.link("object"));
          added.place = spoken(step.link("surface"));
        }
      past_.plans[value.id()] = std::move(plan);
      return {};
    });
  }

  Status read_actions() {
    constexpr int64_t kBegun = 0;
    constexpr int64_t kOver = 2;
    std::map<ltm::MemoryId, LivedAction> begun;
    ENGRAM_RETURN_IF_ERROR(
        visit_all(memory_, "Skill/Event/robot", [&](const LivedValue& value) -> Status {
          ENGRAM_ASSIGN_OR_RETURN(const int64_t stage, value.integer("stage", kOver));
          if (stage == kBegun) return read_begin(value, begun[value.id()]);
          if (stage != kOver) return {};
          ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId execution, value.instance("execution"));
          return read_end(value, begun[execution]);
        }));
    for (auto& [id, action] : begun) {
      if (!action.begun.has_entity())
        return invalid_argument("'{}': needs an event at which it began", id.printable());
      if (action.ended && *action.ended < action.started)
        return invalid_argument("'{}': ended at {}, before it began", id.printable(),
                                to_string(*action.ended));
      past_.actions.push_back(std::move(action));
    }
    return {};
  }

  Status read_begin(const LivedValue& value, LivedAction& action) {
    action.begun = value.id();
    action.started = value.time();
    return read_about(value, action);
  }

  Status read_end(const LivedValue& value, LivedAction& action) {
    constexpr std::array kOutcomes{"running", "success", "failure", "stop", "lost"};
    ENGRAM_ASSIGN_OR_RETURN(const int64_t outcome, value.integer("outcome", kOutcomes.size() - 1));
    if (outcome == 0) return value.wrong("outcome", "one of what ended");
    action.outcome = kOutcomes.at(static_cast<size_t>(outcome));
    action.over = value.id();
    action.ended = value.time();
    ENGRAM_ASSIGN_OR_RETURN(action.stopped_by, value.instances("stopped_by"));
    ENGRAM_ASSIGN_OR_RETURN(action.reason, value.text("reason"));
    return read_about(value, action);
  }

  /// What both events of an execution tell.
  Status read_about(const LivedValue& value, LivedAction& action) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string skill, value.text("skill"));
    action.skill = skill.substr(skill.find('/') + 1);
    action.thing = spoken(value.link("object_before"));
    action.place = spoken(value.link("surface"));
    action.plan = value.link("plan");
    ENGRAM_ASSIGN_OR_RETURN(action.hand, value.text("hand"));
    return {};
  }

  Status read_stands() {
    return visit_all(memory_, "RobotState/Localization", [&](const LivedValue& value) -> Status {
      const auto* pose = value.find<idf::NdArray>("pose_world_platform");
      if (pose == nullptr || pose->type() != idf::ElementType::kFloat32 || pose->count() != 3)
        return invalid_argument("'{}': needs three numbers 'pose_world_platform'",
                                value.id().printable());
      const auto numbers = pose->values<float>();
      past_.stands.push_back({value.id(), value.time(), {numbers[0], numbers[1]}});
      return {};
    });
  }

  /// Values come entity by entity.
  void sort_by_time() {
    const auto by_time = [](const auto& a, const auto& b) { return a.time < b.time; };
    std::stable_sort(past_.words.begin(), past_.words.end(), by_time);
    std::stable_sort(past_.stands.begin(), past_.stands.end(), by_time);
    for (auto& [thing, sights] : past_.sights)
      std::stable_sort(sights.begin(), sights.end(), by_time);
    std::stable_sort(
        past_.actions.begin(), past_.actions.end(),
        [](const LivedAction& a, const LivedAction& b) { return a.started < b.started; });
  }

  [[nodiscard]] std::string spoken(const std::optional<ltm::MemoryId>& id) const {
    if (!id) return {};
    const auto found = spoken_.find(id->entity());
    return found == spoken_.end() ? std::string() : found->second;
  }

  Memory& memory_;
  LivedPast& past_;
  std::map<ltm::MemoryId, std::string> spoken_;  ///< Of classes, instances and surfaces.
};

}  // namespace

bool LivedPlace::carries(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d from = pose.inverse() * point;
  return std::abs(from.x()) < 0.5 * depth_m && std::abs(from.y()) < 0.5 * width_m && from.z() > 0 &&
         from.z() < kMaxStandHeight_m;
}

Result<LivedPast> LivedPast::read(Memory& memory) {
  LivedPast past;
  ENGRAM_RETURN_IF_ERROR(PastReader(memory, past).read());
  return past;
}

LivedPast LivedPast::until(Time now) const {
  const auto keep_known = [now](auto& list) {
    std::erase_if(list, [now](const auto& one) { return one.time > now; });
  };
  LivedPast known = *this;
  keep_known(known.words);
  keep_known(known.stands);
  for (auto& [thing, seen] : known.sights) keep_known(seen);
  std::erase_if(known.sights, [](const auto& one) { return one.second.empty(); });
  std::erase_if(known.plans, [now](const auto& one) { return one.second.time > now; });
  std::erase_if(known.actions, [now](const LivedAction& one) { return one.started > now; });
  for (LivedAction& action : known.actions) {
    if (!action.ended || *action.ended <= now) continue;
    action.over.reset();
    action.ended.reset();
    action.outcome = LivedAction().outcome;
    action.reason.clear();
    action.stopped_by.clear();
  }
  std::erase_if(known.recordings, [now](const auto& one) { return one.first > now; });
  for (auto& [from, to] : known.recordings) to = std::min(to, now);
  return known;
}

const LivedWords* LivedPast::words_of(const ltm::MemoryId& id) const {
  const auto found =
      std::find_if(words.begin(), words.end(), [&](const LivedWords& one) { return one.id == id; });
  return found == words.end() ? nullptr : &*found;
}

const LivedPlan* LivedPast::plan_of(const LivedAction& action) const {
  const auto found = action.plan ? plans.find(*action.plan) : plans.end();
  return found == plans.end() ? nullptr : &found->second;
}

const LivedWords* LivedPast::command_of(const LivedAction& action) const {
  const LivedPlan* plan = plan_of(action);
  return plan == nullptr || !plan->command ? nullptr : words_of(*plan->command);
}

const LivedSight* LivedPast::sight_at(const std::string& thing, Time time) const {
  const auto all = sights.find(thing);
  if (all == sights.end()) return nullptr;
  const auto after =
      std::upper_bound(all->second.begin(), all->second.end(), time,
                       [](Time wanted, const LivedSight& one) { return wanted < one.time; });
  if (after == all->second.begin()) return nullptr;
  const LivedSight& sight = *std::prev(after);
  return time - sight.time > kMaxSightAge ? nullptr : &sight;
}

std::string LivedPast::place_below(const LivedSight& sight) const {
  if (!sight.held_by.empty()) return {};
  for (auto [name, place] : places) {
    if (!place.carries(sight.at)) continue;
    place.depth_m -= 2 * kClearlyOn_m;
    place.width_m -= 2 * kClearlyOn_m;
    return place.carries(sight.at) ? name : std::string();
  }
  return {};
}

}  // namespace engram::speech::dialogues
