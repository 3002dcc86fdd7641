// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <tuple>

#include <Eigen/Geometry>

#include "ltm/context/meeting.h"

namespace engram::ltm {

namespace {

using Sighting = where::InView::Sighting;
using Visibility = EntityContext::Visibility;

constexpr uint32_t kNone = UINT32_MAX;

/// The rows of snapshots in a table. Snapshots are asked for nearly in order, so the next rows are
/// where the last ones ended.
class RowCursor {
 public:
  explicit RowCursor(const std::vector<uint32_t>& snapshots) : snapshots_(snapshots) {}

  struct Rows {
    size_t begin = 0, end = 0;
  };
  Rows of(uint32_t snapshot) {
    if (rows_.begin > 0 && snapshots_[rows_.begin - 1] >= snapshot)
      rows_.begin = first_row(snapshots_, snapshot);
    while (rows_.begin < snapshots_.size() && snapshots_[rows_.begin] < snapshot) ++rows_.begin;
    rows_.end = rows_.begin;
    while (rows_.end < snapshots_.size() && snapshots_[rows_.end] == snapshot) ++rows_.end;
    return rows_;
  }

 private:
  const std::vector<uint32_t>& snapshots_;
  Rows rows_;
};

/// Finds snapshots by time, which are asked for nearly in order, too.
class TimeCursor {
 public:
  explicit TimeCursor(const std::vector<Time>& times) : times_(times) {}

  /// The last one until a time; kNone if there is none.
  uint32_t last_until(Time time) {
    if (behind_ > 0 && times_[behind_ - 1] > time)
      behind_ = static_cast<size_t>(std::ranges::upper_bound(times_, time) - times_.begin());
    while (behind_ < times_.size() && times_[behind_] <= time) ++behind_;
    return behind_ == 0 ? kNone : static_cast<uint32_t>(behind_ - 1);
  }

  /// The one of exactly this time; kNone if there is none.
  uint32_t at(Time time) {
    const uint32_t last = last_until(time);
    return last != kNone && times_[last] == time ? last : kNone;
  }

 private:
  const std::vector<Time>& times_;
  size_t behind_ = 0;  ///< One behind the last one until the time that was asked for.
};

/// A camera and what it looks at.
class Looking {
 public:
  Looking(const MemoryId& camera, const EntityContext& camera_context, const MemoryId& thing,
          const EntityContext& thing_context, Sighting sighting, KnownContexts& contexts)
      : camera_id_(camera),
        camera_(camera_context),
        thing_id_(thing),
        thing_(thing_context),
        sighting_(sighting),
        contexts_(contexts),
        camera_rows_(camera_.cameras.snapshot),
        place_rows_(thing_.places.snapshot),
        link_rows_(thing_.links.snapshot),
        camera_times_(camera_.times),
        thing_times_(thing_.times),
        target_(target_of_camera()) {
    for (size_t i = 0; i < thing_.links.size(); ++i)
      if (is_of_image(i)) seen_at_.push_back(thing_.links.time[i]);
    std::ranges::sort(seen_at_);
    for (const std::string& frame : camera_.frames) {
      const auto found = std::ranges::find(thing_.frames, frame);
      frames_.push_back(frame.empty() || found == thing_.frames.end()
                            ? kNone
                            : static_cast<uint32_t>(found - thing_.frames.begin()));
    }
  }

  /// Errors: kFailedPrecondition if it cannot be told whether the thing was seen.
  [[nodiscard]] Status check() const {
    if (thing_.places.size() == 0 || frames_of(thing_).empty())
      return no_place(thing_id_, thing_, "");
    if (frames_of(camera_).empty()) return no_place(camera_id_, camera_, "");
    if (std::ranges::all_of(frames_, [](uint32_t frame) { return frame == kNone; }))
      return failed_precondition(
          "'{}' and '{}' have no frame in common: places are in {} and in {}",
          camera_id_.to_string(), thing_id_.to_string(), frames_of(camera_), frames_of(thing_));
    if (sighting_ != Sighting::kAny && thing_.visibility.empty() && seen_at_.empty())
      return failed_precondition(
          "'{}' does not tell whether it was seen: needs a bool 'is_visible', or links to images "
          "of "
          "'{}'",
          thing_id_.to_string(), camera_id_.to_string());
    return {};
  }

  /// Whether a snapshot of the camera and one of the thing are what is asked for.
  Result<bool> holds(uint32_t camera, uint32_t thing) {
    if (sighting_ != Sighting::kAny) {
      const bool is_seen = was_seen(camera_.times[camera], thing);
      if (is_seen != (sighting_ == Sighting::kSeen)) return false;
      find_linked_instances(thing);
    }
    if (camera != looking_) ENGRAM_RETURN_IF_ERROR(look_with(camera));
    const RowCursor::Rows places = place_rows_.of(thing);
    for (const Eye& eye : eyes_) {
      // Which of several cameras a thing is seen with is told by its link to the image.
      if (!linked_.empty() && std::ranges::find(linked_, eye.instance) == linked_.end()) continue;
      for (size_t i = places.begin; i < places.end; ++i) {
        if (thing_.places.frame[i] != eye.frame) continue;
        const Projection at = project(eye, i);
        if (!at.is_in_image) continue;
        if (sighting_ != Sighting::kInVain) return true;
        // What is known to be hidden was not looked for in vain.
        ENGRAM_ASSIGN_OR_RETURN(const bool hidden, is_hidden(eye, camera, at));
        if (!hidden) return true;
      }
    }
    return false;
  }

  /// The snapshot of the camera that a snapshot of the thing belongs to: the one that it links to,
  /// or else the last one until then; kNone if there is none.
  uint32_t camera_of(uint32_t thing) {
    const RowCursor::Rows links = link_rows_.of(thing);
    for (size_t i = links.begin; i < links.end; ++i)
      if (is_of_image(i))
        if (const uint32_t found = camera_times_.at(time_from_ns(thing_.links.time[i]));
            found != kNone)
          return found;
    return camera_times_.last_until(thing_.times[thing]);
  }

  /// The thing as it was at a time; kNone if it was not there yet.
  uint32_t thing_at(Time time) { return thing_times_.last_until(time); }

 private:
  /// One camera of a snapshot, ready to look.
  struct Eye {
    int32_t instance = 0;
    uint32_t frame = kNone;  ///< Among those of the thing.
    Eigen::Matrix3d to_camera;
    Eigen::Vector3d position;
    Intrinsics intrinsics;
  };

  [[nodiscard]] uint32_t target_of_camera() const {
    const auto found = std::ranges::find(thing_.targets, camera_id_);
    return found == thing_.targets.end() ? kNone
                                         : static_cast<uint32_t>(found - thing_.targets.begin());
  }

  /// Whether a link of the thing leads to a snapshot of the camera.
  [[nodiscard]] bool is_of_image(size_t link) const {
    return thing_.links.target[link] == target_ &&
           thing_.links.time[link] != EntityContext::Links::kNoTime;
  }

  /// Finds the instances of the camera that a snapshot of the thing links to.
  void find_linked_instances(uint32_t thing) {
    linked_.clear();
    const RowCursor::Rows links = link_rows_.of(thing);
    for (size_t i = links.begin; i < links.end; ++i)
      if (thing_.links.target[i] == target_ &&
          thing_.links.index[i] != EntityContext::Links::kNoInstance)
        linked_.push_back(thing_.links.index[i]);
  }

  /// Makes the eyes of a snapshot of the camera. One without intrinsics or without a frame of the
  /// thing sees nothing.
  Status look_with(uint32_t camera) {
    looking_ = camera;
    eyes_.clear();
    const RowCursor::Rows rows = camera_rows_.of(camera);
    for (size_t row = rows.begin; row < rows.end; ++row) {
      Eye eye;
      eye.instance = camera_.cameras.instance[row];
      eye.frame = frames_[camera_.cameras.frame[row]];
      const double* q = &camera_.cameras.orientation[4 * row];
      const Eigen::Quaterniond orientation(q[0], q[1], q[2], q[3]);
      if (eye.frame == kNone || orientation.squaredNorm() == 0) continue;
      ENGRAM_ASSIGN_OR_RETURN(const Intrinsics* const intrinsics, intrinsics_of(row));
      if (intrinsics == nullptr) continue;
      eye.to_camera = orientation.normalized().conjugate().toRotationMatrix();
      eye.position = Eigen::Vector3d(&camera_.cameras.position[3 * row]);
      eye.intrinsics = *intrinsics;
      eyes_.push_back(eye);
    }
    return {};
  }

  /// Null if the camera has none there. Valid as long as this object.
  Result<const Intrinsics*> intrinsics_of(size_t row) {
    const int32_t calibration = camera_.cameras.calibration[row];
    if (calibration < 0) return &camera_.intrinsics[static_cast<size_t>(-1 - calibration)];
    const auto link = static_cast<size_t>(calibration);
    const auto key =
        std::tuple(camera_.links.target[link], camera_.links.time[link], camera_.links.index[link]);
    auto known = calibrations_.find(key);
    if (known == calibrations_.end()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto read, contexts_.intrinsics(camera_.link(link)));
      known = calibrations_.emplace(key, read).first;
    }
    return known->second ? &*known->second : nullptr;
  }

  /// A place in an image. Unit: pixels, and m along the optical axis.
  struct Projection {
    double u = 0, v = 0, z = 0;
    bool is_in_image = false;
  };
  [[nodiscard]] Projection project(const Eye& eye, size_t place) const {
    const Eigen::Vector3d seen =
        eye.to_camera * (Eigen::Vector3d(&thing_.places.position[3 * place]) - eye.position);
    Projection to;
    to.z = seen.z();
    if (to.z <= 0) return to;
    const Intrinsics& lens = eye.intrinsics;
    to.u = lens.fx * seen.x() / seen.z() + lens.cx;
    to.v = lens.fy * seen.y() / seen.z() + lens.cy;
    to.is_in_image =
        to.u >= -0.5 && to.u < lens.width - 0.5 && to.v >= -0.5 && to.v < lens.height - 0.5;
    return to;
  }

  /// Whether depth images say that something was before a place.
  Result<bool> is_hidden(const Eye& eye, uint32_t camera, const Projection& at) {
    const MemoryId image = camera_id_.at(camera_.times[camera]).instance(eye.instance);
    ENGRAM_ASSIGN_OR_RETURN(const auto hidden,
                            contexts_.is_hidden(image, (at.u + 0.5) / eye.intrinsics.width,
                                                (at.v + 0.5) / eye.intrinsics.height, at.z));
    return hidden.value_or(false);
  }

  [[nodiscard]] bool was_seen(Time image, uint32_t thing) const {
    if (!thing_.visibility.empty() && thing_.visibility[thing] != Visibility::kUntold)
      return thing_.visibility[thing] == Visibility::kVisible;
    const int64_t time = to_ns(image);
    const auto next = std::ranges::lower_bound(seen_at_, time);
    const auto is_close = [time](int64_t seen) {
      const Duration apart(seen > time ? seen - time : time - seen);
      return apart <= kSeenTolerance;
    };
    return (next != seen_at_.end() && is_close(*next)) ||
           (next != seen_at_.begin() && is_close(*std::prev(next)));
  }

  const MemoryId& camera_id_;
  const EntityContext& camera_;
  const MemoryId& thing_id_;
  const EntityContext& thing_;
  const Sighting sighting_;
  KnownContexts& contexts_;
  RowCursor camera_rows_, place_rows_, link_rows_;
  TimeCursor camera_times_, thing_times_;
  const uint32_t target_;         ///< The camera among what the thing links to; kNone: not there.
  std::vector<uint32_t> frames_;  ///< Of each frame of the camera the index among the thing's.
  std::vector<int64_t> seen_at_;  ///< Times of the images that the thing links to, sorted.
  std::vector<int32_t> linked_;   ///< The instances that the thing links to; empty: it names none.
  uint32_t looking_ = kNone;      ///< The snapshot that `eyes_` are of.
  std::vector<Eye> eyes_;
  std::map<std::tuple<uint32_t, int64_t, int32_t>, std::optional<Intrinsics>> calibrations_;
};

}  // namespace

Result<Met> meet_view(const Asked& asked, const where::InView& view, const EntityContext& other,
                      KnownContexts& contexts) {
  Met met(asked.context.times.size(), 0);
  const bool is_camera = asked.context.cameras.size() > 0;
  if (!is_camera && other.cameras.size() == 0) {
    if (!asked.is_named && other.places.size() > 0) return met;
    return failed_precondition(
        "neither '{}' nor '{}' is a camera: needs a pose, and fx, fy, cx, cy, width and height or "
        "a "
        "link to them in a member 'calibration'",
        asked.id.to_string(), view.entity.to_string());
  }
  Looking looking =
      is_camera ? Looking(asked.id, asked.context, view.entity, other, view.sighting, contexts)
                : Looking(view.entity, other, asked.id, asked.context, view.sighting, contexts);
  if (const Status checked = looking.check(); !checked.ok()) {
    if (asked.is_named) return checked;
    return met;
  }
  for (uint32_t i = 0; i < met.size(); ++i) {
    const uint32_t opposite =
        is_camera ? looking.thing_at(asked.context.times[i]) : looking.camera_of(i);
    if (opposite == kNone) continue;
    ENGRAM_ASSIGN_OR_RETURN(const bool holds,
                            is_camera ? looking.holds(i, opposite) : looking.holds(opposite, i));
    met[i] = holds ? 1 : 0;
  }
  return met;
}

}  // namespace engram::ltm
