// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kitchen_scene_source.h"

#include "datasets/kitchen/entities.h"
#include "datasets/kitchen/kitchen_types.h"
#include "datasets/kitchen/movable_places.h"
#include "ltm/typed/image.h"

namespace engram::datasets {

namespace {

using ::kitchen::ObjectInstance;

/// The maximum movement of a thing that rests.
constexpr double kRests_m = 5e-4;
constexpr double kRests_rad = 5e-3;

/// The recorded values of one entity around a moment.
class Around {
 public:
  static Result<Around> find(ltm::StoreReader& store, const ltm::MemoryId& entity, Time time) {
    Around around;
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, store.timeline(entity));
    ENGRAM_ASSIGN_OR_RETURN(around.before, timeline->at_or_before(time));
    ENGRAM_ASSIGN_OR_RETURN(around.after, timeline->at_or_after(time));
    return around;
  }

  std::optional<ltm::SnapshotEntry> before;
  std::optional<ltm::SnapshotEntry> after;
};

bool rests(const ObjectInstance& before, const ObjectInstance& after) {
  const auto& a = before.pose_world_object;
  const auto& b = after.pose_world_object;
  return before.held_by.empty() && after.held_by.empty() &&
         (a.position - b.position).norm() < kRests_m &&
         a.orientation.normalized().angularDistance(b.orientation.normalized()) < kRests_rad;
}

/// Collects the values of a moment; `is_whole` tells whether all of them were found.
class MomentReader {
 public:
  MomentReader(ltm::StoreReader& store, Time time) : store_(store), time_(time) {}

  /// Returns true if the value was found.
  Result<bool> take(const ltm::MemoryId& id, idf::Data& value) {
    if (!id.time()) return false;
    ENGRAM_ASSIGN_OR_RETURN(auto found, recorded_at(store_, id.entity(), *id.time()));
    if (found) value = *std::move(found);
    return found.has_value();
  }

  /// Finds the recording that the moment belongs to, and when it began.
  Result<bool> take_recording(idf::Data& value, Time& began) {
    const ltm::MemoryId id = kitchen::entities::recording();
    const auto timeline = store_.timeline(id);
    if (timeline.status().code() == StatusCode::kNotFound) return false;
    ENGRAM_RETURN_IF_ERROR(timeline.status());
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, (*timeline)->at_or_before(time_));
    if (!entry) return false;
    began = entry->time;
    return take(id.at(began), value);
  }

  /// Returns the value of an object of the recording at the moment. Returns nothing if the
  /// recording has no such object; sets `is_whole` to false if its place is not known.
  Result<std::optional<idf::Data>> object(const ltm::MemoryId& entity, Time began, bool& is_whole) {
    ENGRAM_ASSIGN_OR_RETURN(const Around around, Around::find(store_, entity, time_));
    if (!around.before || around.before->time < began) return std::optional<idf::Data>();
    ENGRAM_ASSIGN_OR_RETURN(auto before, recorded_at(store_, entity, around.before->time));
    if (!before) {
      is_whole = false;
      return before;
    }
    if (around.before->time == time_) return before;
    ENGRAM_ASSIGN_OR_RETURN(const ObjectInstance was, ObjectInstance::from_idf(*before));
    is_whole &= was.held_by.empty();
    if (!around.after) return before;
    ENGRAM_ASSIGN_OR_RETURN(const auto after, recorded_at(store_, entity, around.after->time));
    if (after) {
      ENGRAM_ASSIGN_OR_RETURN(const ObjectInstance is, ObjectInstance::from_idf(*after));
      is_whole &= rests(was, is);
    }
    return before;
  }

 private:
  ltm::StoreReader& store_;
  Time time_;
};

}  // namespace

Result<std::optional<RememberedScene>> KitchenSceneSource::scene(ltm::StoreReader& store,
                                                                 const ltm::Snapshot& snapshot,
                                                                 size_t index) {
  const std::optional<RememberedScene> nothing;
  const idf::Data& value = snapshot.instances[index].data;
  const auto view = ::kitchen::View::from_idf(value);
  if (!view.ok()) return nothing;
  MomentReader reader(store, snapshot.time);
  KitchenMoment moment;
  moment.view = value;
  Time began{};
  ENGRAM_ASSIGN_OR_RETURN(bool is_whole, reader.take_recording(moment.recording, began));
  if (!is_whole) return nothing;
  ENGRAM_ASSIGN_OR_RETURN(const bool has_camera,
                          reader.take(view->calibration, moment.calibration));
  ENGRAM_ASSIGN_OR_RETURN(const bool has_joints, reader.take(view->joints, moment.joints));
  ENGRAM_ASSIGN_OR_RETURN(const bool has_platform, reader.take(view->platform, moment.platform));
  if (!has_camera || !has_joints || !has_platform) return nothing;
  std::vector<std::string> in_sight;
  const ltm::MemoryId objects =
      kitchen::entities::object(kitchen::all_thing_classes().front()).parent();
  for (const ltm::MemoryId& entity : store.entities()) {
    if (entity.parent() != objects) continue;
    ENGRAM_ASSIGN_OR_RETURN(auto object, reader.object(entity, began, is_whole));
    if (!object) continue;
    ENGRAM_ASSIGN_OR_RETURN(const ObjectInstance thing, ObjectInstance::from_idf(*object));
    if (kitchen::is_movable(entity)) {
      // Scenes have no chair and no person, so they would not look as it was.
      is_whole &= kitchen::is_away(
          Eigen::Isometry3d(Eigen::Translation3d(thing.pose_world_object.position)));
      continue;
    }
    if (thing.is_visible) in_sight.push_back(entity.names().back());
    moment.objects.emplace_back(entity, *std::move(object));
  }
  if (!is_whole || moment.objects.empty()) return nothing;
  ENGRAM_ASSIGN_OR_RETURN(augmentation::Scene scene, scenes_.scene(moment));
  return std::optional(RememberedScene{std::move(scene), std::move(in_sight)});
}

Result<idf::Data> KitchenSceneSource::seen(const idf::Data& recorded,
                                           const augmentation::SceneCamera& camera,
                                           const idf::NdArray& image) const {
  ENGRAM_ASSIGN_OR_RETURN(::kitchen::View view, ::kitchen::View::from_idf(recorded));
  const auto pixels = typed::mat_of(image);
  if (!pixels || pixels->type() != CV_8UC3)
    return invalid_argument("rendered image: found {} {}, needs uint8 [height, width, 3]",
                            idf::to_string(image.type()), idf::to_string(image.shape()));
  view.image = *pixels;
  using Pose = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Pose pose = Eigen::Map<const Pose>(camera.pose.data());
  view.pose_world_camera.position = pose.block<3, 1>(0, 3);
  view.pose_world_camera.orientation = Eigen::Quaterniond(Eigen::Matrix3d(pose.block<3, 3>(0, 0)));
  return view.to_idf();
}

}  // namespace engram::datasets
