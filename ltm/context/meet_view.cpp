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
        target_(target_of_camera()) {
    for (size_t i = 0; target_ && i < thing_.links.size(); ++i)
      if (thing_.links.target[i] == *target_ &&
          thing_.links.time[i] != EntityContext::Links::kNoTime)
        seen_at_.push_back(thing_.links.time[i]);
    std::ranges::sort(seen_at_);
  }

  /// Errors: kFailedPrecondition if it cannot be told whether the thing was seen.
  Status check() const {
    if (thing_.places.size() == 0 || frames_of(thing_).empty())
      return no_place(thing_id_, thing_, "");
    if (frames_of(camera_).empty()) return no_place(camera_id_, camera_, "");
    const bool shares = std::ranges::any_of(camera_.frames, [this](const std::string& frame) {
      return !frame.empty() && std::ranges::find(thing_.frames, frame) != thing_.frames.end();
    });
    if (!shares)
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
    const std::vector<int32_t> linked = linked_instances(thing);
    bool is_in_view = false;
    for (size_t i = first_row(camera_.cameras.snapshot, camera);
         i < camera_.cameras.size() && camera_.cameras.snapshot[i] == camera; ++i) {
      // Which of several cameras a thing is seen with is told by its link to the image.
      if (sighting_ != Sighting::kAny && !linked.empty() &&
          std::ranges::find(linked, camera_.cameras.instance[i]) == linked.end())
        continue;
      ENGRAM_ASSIGN_OR_RETURN(const auto intrinsics, intrinsics_of(i));
      if (!intrinsics) continue;
      ENGRAM_ASSIGN_OR_RETURN(const bool is_in, projects(i, *intrinsics, camera, thing));
      is_in_view = is_in_view || is_in;
    }
    if (!is_in_view || sighting_ == Sighting::kAny) return is_in_view;
    const bool is_seen = was_seen(camera_.times[camera], thing);
    return sighting_ == Sighting::kSeen ? is_seen : !is_seen;
  }

  /// The snapshot of the camera that a snapshot of the thing belongs to: the one that it links to,
  /// or else the last one until then.
  [[nodiscard]] std::optional<uint32_t> camera_of(uint32_t thing) const {
    for (size_t i = first_row(thing_.links.snapshot, thing);
         target_ && i < thing_.links.size() && thing_.links.snapshot[i] == thing; ++i)
      if (thing_.links.target[i] == *target_ &&
          thing_.links.time[i] != EntityContext::Links::kNoTime)
        if (const auto found = camera_.find(time_from_ns(thing_.links.time[i]))) return found;
    return last_until(camera_, thing_.times[thing]);
  }

  /// The thing as it was at a time.
  [[nodiscard]] std::optional<uint32_t> thing_at(Time time) const {
    return last_until(thing_, time);
  }

 private:
  static std::optional<uint32_t> last_until(const EntityContext& context, Time time) {
    const auto behind = std::ranges::upper_bound(context.times, time);
    if (behind == context.times.begin()) return std::nullopt;
    return static_cast<uint32_t>(behind - context.times.begin() - 1);
  }

  [[nodiscard]] std::optional<uint32_t> target_of_camera() const {
    const auto found = std::ranges::find(thing_.targets, camera_id_);
    if (found == thing_.targets.end()) return std::nullopt;
    return static_cast<uint32_t>(found - thing_.targets.begin());
  }

  /// The instances of the camera that a snapshot of the thing links to.
  [[nodiscard]] std::vector<int32_t> linked_instances(uint32_t thing) const {
    std::vector<int32_t> instances;
    for (size_t i = first_row(thing_.links.snapshot, thing);
         target_ && i < thing_.links.size() && thing_.links.snapshot[i] == thing; ++i)
      if (thing_.links.target[i] == *target_ &&
          thing_.links.index[i] != EntityContext::Links::kNoInstance)
        instances.push_back(thing_.links.index[i]);
    return instances;
  }

  Result<std::optional<Intrinsics>> intrinsics_of(size_t row) {
    const int32_t calibration = camera_.cameras.calibration[row];
    if (calibration < 0)
      return std::optional(camera_.intrinsics[static_cast<size_t>(-1 - calibration)]);
    const auto link = static_cast<size_t>(calibration);
    const auto key =
        std::tuple(camera_.links.target[link], camera_.links.time[link], camera_.links.index[link]);
    if (const auto known = calibrations_.find(key); known != calibrations_.end())
      return known->second;
    MemoryId id = camera_.targets[camera_.links.target[link]];
    if (camera_.links.time[link] != EntityContext::Links::kNoTime)
      id = id.at(time_from_ns(camera_.links.time[link]));
    if (id.time() && camera_.links.index[link] != EntityContext::Links::kNoInstance)
      id = id.instance(camera_.links.index[link]);
    ENGRAM_ASSIGN_OR_RETURN(const auto read, contexts_.intrinsics(id));
    calibrations_.emplace(key, read);
    return read;
  }

  /// Whether a place of the thing projects into the image of a row of the camera. What is known to
  /// be hidden was not looked for in vain.
  Result<bool> projects(size_t row, const Intrinsics& intrinsics, uint32_t camera, uint32_t thing) {
    const auto& cameras = camera_.cameras;
    const std::string& frame = camera_.frames[cameras.frame[row]];
    if (frame.empty()) return false;
    const double* q = &cameras.orientation[4 * row];
    const Eigen::Quaterniond orientation(q[0], q[1], q[2], q[3]);
    if (orientation.squaredNorm() == 0) return false;
    const Eigen::Vector3d position(&cameras.position[3 * row]);
    for (size_t i = first_row(thing_.places.snapshot, thing);
         i < thing_.places.size() && thing_.places.snapshot[i] == thing; ++i) {
      if (thing_.frames[thing_.places.frame[i]] != frame) continue;
      const Eigen::Vector3d place(&thing_.places.position[3 * i]);
      const Eigen::Vector3d seen = orientation.normalized().conjugate() * (place - position);
      if (seen.z() <= 0) continue;
      const double u = intrinsics.fx * seen.x() / seen.z() + intrinsics.cx;
      const double v = intrinsics.fy * seen.y() / seen.z() + intrinsics.cy;
      if (!(u >= -0.5 && u < intrinsics.width - 0.5 && v >= -0.5 && v < intrinsics.height - 0.5))
        continue;
      if (sighting_ != Sighting::kInVain || was_seen(camera_.times[camera], thing)) return true;
      const MemoryId image = camera_id_.at(camera_.times[camera]).instance(cameras.instance[row]);
      ENGRAM_ASSIGN_OR_RETURN(const auto hidden,
                              contexts_.is_hidden(image, (u + 0.5) / intrinsics.width,
                                                  (v + 0.5) / intrinsics.height, seen.z()));
      if (!hidden.value_or(false)) return true;
    }
    return false;
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
  const std::optional<uint32_t> target_;  ///< The camera among what the thing links to.
  std::vector<int64_t> seen_at_;          ///< Times of the images that the thing links to, sorted.
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
    const auto opposite =
        is_camera ? looking.thing_at(asked.context.times[i]) : looking.camera_of(i);
    if (!opposite) continue;
    ENGRAM_ASSIGN_OR_RETURN(const bool holds,
                            is_camera ? looking.holds(i, *opposite) : looking.holds(*opposite, i));
    met[i] = holds ? 1 : 0;
  }
  return met;
}

}  // namespace engram::ltm
