// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/floor_things.h"

#include <cmath>

#include "ltm/core/log.h"
#include "memory/live/subscription.h"
#include "server/navigation/thing_members.h"

namespace engram::navigation {

namespace {

std::string text_in(const idf::Data& data, const std::string& member) {
  const idf::Data* value = member.empty() ? nullptr : data.at(member);
  const auto* text = value == nullptr ? nullptr : value->get_if<std::string>();
  return text == nullptr ? std::string() : *text;
}

std::optional<ltm::MemoryId> class_linked_by(const idf::Data& data, const std::string& member) {
  const auto id = ltm::MemoryId::parse(text_in(data, member));
  if (!id.ok() || !id->has_entity()) return {};
  return id->entity();
}

}  // namespace

/// A thing in space, as far as the floor is concerned.
struct FloorThings::Outline {
  Obstacle obstacle;
  double bottom_m = 0;
  double top_m = 0;
};

Result<FloorThings> FloorThings::create(MapRules rules) {
  ENGRAM_RETURN_IF_ERROR(rules.validate());
  std::vector<ltm::Query> queries;
  for (const ObstacleSource& source : rules.sources) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Query query, subscribed_names({source.names}));
    queries.push_back(std::move(query));
  }
  // Without names of classes a query would match everything.
  ENGRAM_ASSIGN_OR_RETURN(ltm::Query classes, subscribed_names(rules.class_names));
  return FloorThings(std::move(rules), std::move(queries), std::move(classes));
}

FloorThings::FloorThings(MapRules rules, std::vector<ltm::Query> queries, ltm::Query classes)
    : rules_(std::move(rules)), queries_(std::move(queries)) {
  if (!rules_.class_names.empty()) classes_query_ = std::move(classes);
  for (const std::string& name : rules_.ignored)
    ignored_.push_back(ltm::NamePattern::parse(name).value());
  for (const SpeedRule& rule : rules_.speeds)
    speed_names_.push_back(ltm::NamePattern::parse(rule.name).value());
}

std::vector<std::string> FloorThings::names() const {
  std::vector<std::string> names = rules_.class_names;
  for (const ObstacleSource& source : rules_.sources) names.push_back(source.names);
  return names;
}

bool FloorThings::take(const ltm::Snapshot& snapshot) {
  if (snapshot.instances.empty()) return false;
  if (classes_query_ && classes_query_->matches(snapshot.entity)) {
    auto [known, is_new] = classes_.try_emplace(snapshot.entity);
    if (!is_new && known->second.first >= snapshot.time) return true;
    known->second = {snapshot.time, snapshot.instances.front().data};
    for (auto& [entity, thing] : things_)
      if (thing.object_class == snapshot.entity) look_at(entity, thing);
    return true;
  }
  for (size_t i = 0; i < queries_.size(); ++i) {
    if (!queries_[i].matches(snapshot.entity)) continue;
    Known& thing = things_[snapshot.entity];
    const bool is_new = thing.source == nullptr;
    if (!is_new && thing.time >= snapshot.time) return true;
    thing.source = &rules_.sources[i];
    thing.time = snapshot.time;
    thing.snapshot = snapshot.id().instance(0);
    thing.data = snapshot.instances.front().data;
    thing.object_class = class_linked_by(thing.data, thing.source->class_member);
    newest_ = std::max(newest_, snapshot.time);
    const bool is_elsewhere = look_at(snapshot.entity, thing);
    // What stands on a surface depends on where that is, and how high.
    if (thing.source->is_surface && is_elsewhere)
      for (auto& [entity, other] : things_)
        if (!other.source->is_surface) look_at(entity, other);
    return true;
  }
  return false;
}

bool FloorThings::look_at(const ltm::MemoryId& entity, Known& thing) {
  constexpr double kSameHeightM = 1e-3;
  const std::optional<Obstacle> before = std::move(thing.obstacle);
  const std::string left_out_before = std::move(thing.left_out);
  const double top_before_m = thing.top_m;
  auto found = obstacle_of(entity, thing);
  if (!found.ok() && left_out_before.empty())
    log::warning("navigation: the map leaves out '{}': {}", entity.printable(),
                 found.status().message());
  thing.left_out = found.ok() ? std::string() : found.status().message();
  thing.obstacle = found.ok() ? *std::move(found) : std::nullopt;
  const bool is_same = before.has_value() == thing.obstacle.has_value() &&
                       (!before || before->is_at(*thing.obstacle));
  // Small steps must not add up: what counts as being where it was is compared with what the map
  // has of it, not with the snapshot before.
  if (is_same && before) {
    const ltm::MemoryId seen = thing.obstacle->snapshot;
    thing.obstacle = before;
    thing.obstacle->snapshot = seen;
  }
  const bool is_as_high = std::abs(thing.top_m - top_before_m) <= kSameHeightM;
  if (is_as_high) thing.top_m = top_before_m;
  // A map tells what it leaves out, so a new reason is a change as well.
  if (!is_same || thing.left_out != left_out_before) changed_.insert(entity);
  return !is_same || !is_as_high;
}

Result<std::optional<Obstacle>> FloorThings::obstacle_of(const ltm::MemoryId& entity,
                                                         Known& thing) const {
  const std::string& name = entity.names().back();
  for (const ltm::NamePattern& pattern : ignored_)
    if (pattern.matches(name)) return std::optional<Obstacle>();
  if (!text_in(thing.data, thing.source->held_member).empty()) return std::optional<Obstacle>();
  ENGRAM_ASSIGN_OR_RETURN(Outline outline, outline_of(thing));
  thing.top_m = outline.top_m;
  if (outline.top_m < rules_.min_height_m || outline.bottom_m > rules_.max_height_m)
    return std::optional<Obstacle>();
  if (!thing.source->is_surface && stands_on_surface(outline)) return std::optional<Obstacle>();
  outline.obstacle.snapshot = thing.snapshot;
  outline.obstacle.name = name;
  outline.obstacle.max_speed_m_s = max_speed_of(name);
  return std::optional<Obstacle>(std::move(outline.obstacle));
}

Result<FloorThings::Outline> FloorThings::outline_of(const Known& thing) const {
  const ObstacleSource& source = *thing.source;
  ENGRAM_ASSIGN_OR_RETURN(const typed::Pose<double> pose, pose_in(thing.data, source.pose_member));
  Outline outline;
  outline.obstacle.pose_world_obstacle = PlanarPose::of(pose);
  constexpr double kMaxSizeM = 1000;
  if (source.is_surface) {
    const idf::Data* depth = thing.data.at(source.depth_member);
    const idf::Data* width = thing.data.at(source.width_member);
    const double x = depth == nullptr ? 0 : depth->as_number().value_or(0);
    const double y = width == nullptr ? 0 : width->as_number().value_or(0);
    if (!(x > 0 && x < kMaxSizeM && y > 0 && y < kMaxSizeM))
      return invalid_argument("its {} and {} need to be numbers from 0 to {} m",
                              source.depth_member, source.width_member, kMaxSizeM);
    outline.obstacle.size_m = {x, y};
    outline.top_m = pose.position.z();
    return outline;
  }
  const idf::Data* sized = &thing.data;
  if (!source.class_member.empty()) {
    if (!thing.object_class)
      return invalid_argument("it has no class: its {} is no link", source.class_member);
    const auto found = classes_.find(*thing.object_class);
    if (found == classes_.end())
      return invalid_argument("its class '{}' is not known", thing.object_class->printable());
    sized = &found->second.second;
  }
  const auto size = finite_numbers(sized->at(source.size_member), 3);
  if (!size) return invalid_argument("its class has no {} of 3 numbers", source.size_member);
  const Eigen::Vector3d half = Eigen::Vector3d((*size)[0], (*size)[1], (*size)[2]) / 2;
  if (!(half.minCoeff() > 0 && half.maxCoeff() < kMaxSizeM))
    return invalid_argument("its size is {} x {} x {} m, needs more than 0 and less than {}",
                            (*size)[0], (*size)[1], (*size)[2], kMaxSizeM);
  // The box around the thing with the heading of the thing: exact for what stands, and not too
  // small for what lies or leans.
  const Eigen::Matrix3d upright =
      Eigen::AngleAxisd(outline.obstacle.pose_world_obstacle.heading_rad, Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  const Eigen::Matrix3d turned = upright.transpose() * pose.orientation.toRotationMatrix();
  const Eigen::Vector3d reach = turned.cwiseAbs() * half;
  const bool is_upright = std::abs(turned(2, 2)) > 0.99;
  if (is_upright && text_in(*sized, source.shape_member) == "cylinder")
    outline.obstacle.shape = Obstacle::Shape::kCylinder;
  outline.obstacle.size_m = 2 * reach.head<2>();
  if (outline.obstacle.shape == Obstacle::Shape::kCylinder)
    outline.obstacle.size_m.setConstant(outline.obstacle.size_m.maxCoeff());
  outline.bottom_m = pose.position.z() - reach.z();
  outline.top_m = pose.position.z() + reach.z();
  return outline;
}

bool FloorThings::stands_on_surface(const Outline& outline) const {
  // Things sink into what they stand on by some millimetres, and are seen with centimetres of
  // error.
  constexpr double kSunkM = 0.05;
  for (const auto& [entity, surface] : things_)
    if (surface.source->is_surface && surface.obstacle &&
        outline.bottom_m > surface.top_m - kSunkM &&
        surface.obstacle->distance_m(outline.obstacle.pose_world_obstacle.position()) <= 0)
      return true;
  return false;
}

double FloorThings::max_speed_of(const std::string& name) const {
  for (size_t i = 0; i < speed_names_.size(); ++i)
    if (speed_names_[i].matches(name)) return rules_.speeds[i].max_speed_m_s;
  return 0;
}

std::vector<FloorThings::Change> FloorThings::take_changes() {
  std::vector<Change> changes;
  for (const ltm::MemoryId& entity : changed_)
    changes.push_back({entity, things_.at(entity).obstacle});
  changed_.clear();
  return changes;
}

std::vector<Obstacle> FloorThings::obstacles() const {
  std::vector<Obstacle> obstacles;
  for (const auto& [entity, thing] : things_)
    if (thing.obstacle) obstacles.push_back(*thing.obstacle);
  return obstacles;
}

std::vector<LeftOutThing> FloorThings::left_out() const {
  std::vector<LeftOutThing> left_out;
  for (const auto& [entity, thing] : things_)
    if (!thing.left_out.empty()) left_out.push_back({thing.snapshot, thing.left_out});
  return left_out;
}

std::map<ltm::MemoryId, Time> FloorThings::times() const {
  std::map<ltm::MemoryId, Time> times;
  for (const auto& [entity, thing] : things_) times[entity] = thing.time;
  for (const auto& [entity, known] : classes_) times[entity] = known.first;
  return times;
}

std::optional<Time> FloorThings::time_of(const ltm::MemoryId& entity) const {
  if (const auto thing = things_.find(entity); thing != things_.end()) return thing->second.time;
  if (const auto known = classes_.find(entity); known != classes_.end()) return known->second.first;
  return {};
}

}  // namespace engram::navigation
