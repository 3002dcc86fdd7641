// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/looking.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace engram::ltm {

Looking::Looking(const MemoryId& camera, const EntityContext& camera_context, const MemoryId& thing,
                 const EntityContext& thing_context, Sighting sighting, KnownContexts& contexts)
    : camera_id_(camera),
      camera_(camera_context),
      thing_id_(thing),
      thing_(thing_context),
      sighting_(sighting),
      contexts_(contexts),
      visibility_(thing_.visibility.empty() ? nullptr : thing_.visibility.data()),
      camera_rows_(camera_.cameras.snapshot),
      look_rows_(camera_.cameras.snapshot),
      place_rows_(thing_.places.snapshot),
      link_rows_(thing_.links.snapshot),
      camera_times_(camera_.times),
      thing_times_(thing_.times),
      seen_times_(seen_at_) {
  if (const auto found = std::ranges::find(thing_.targets, camera_id_);
      found != thing_.targets.end())
    target_ = static_cast<uint32_t>(found - thing_.targets.begin());
  if (target_ != kNoRow && sighting_ != Sighting::kAny)
    for (size_t i = 0; i < thing_.links.size(); ++i)
      if (is_of_image(i)) seen_at_.push_back(time_from_ns(thing_.links.time[i]));
  if (!std::ranges::is_sorted(seen_at_)) std::ranges::sort(seen_at_);
  for (const std::string& frame : camera_.frames) {
    const auto found = std::ranges::find(thing_.frames, frame);
    frames_.push_back(frame.empty() || found == thing_.frames.end()
                          ? kNoRow
                          : static_cast<uint32_t>(found - thing_.frames.begin()));
  }
  for (const Intrinsics& own : camera_.intrinsics) own_lenses_.push_back({own, planes_of(own)});
  find_runs();
}

Status Looking::check() const {
  if (thing_.places.size() == 0 || frames_of(thing_).empty())
    return no_place(thing_id_, thing_, "");
  if (frames_of(camera_).empty()) return no_place(camera_id_, camera_, "");
  if (std::ranges::all_of(frames_, [](uint32_t frame) { return frame == kNoRow; }))
    return failed_precondition("'{}' and '{}' have no frame in common: places are in {} and in {}",
                               camera_id_.to_string(), thing_id_.to_string(), frames_of(camera_),
                               frames_of(thing_));
  if (sighting_ != Sighting::kAny && thing_.visibility.empty() && seen_at_.empty())
    return failed_precondition(
        "'{}' does not tell whether it was seen: needs a bool 'is_visible', or links to images of "
        "'{}'",
        thing_id_.to_string(), camera_id_.to_string());
  return {};
}

Result<Met> Looking::images_of_thing() {
  Met met(camera_.times.size(), 0);
  ENGRAM_RETURN_IF_ERROR(judge_cameras(met));
  ENGRAM_RETURN_IF_ERROR(without_hidden(met, [this](uint32_t image) {
    return std::pair(image, thing_times_.last_until(camera_.times[image]));
  }));
  return met;
}

Result<Met> Looking::things_in_images() {
  Met met(thing_.times.size(), 0);
  ENGRAM_RETURN_IF_ERROR(target_ == kNoRow ? judge_images(met) : judge_linked(met));
  ENGRAM_RETURN_IF_ERROR(
      without_hidden(met, [this](uint32_t thing) { return std::pair(camera_of(thing), thing); }));
  return met;
}

// No branch depends on what is seen, of which no processor knows the next.
Status Looking::judge_image(uint32_t camera, RowCursor::Rows rows, Met& met) {
  ENGRAM_RETURN_IF_ERROR(glance_with(camera));
  const auto& places = thing_.places;
  const uint32_t* const snapshots = places.snapshot.data();
  const double* const positions = places.position.data();
  const uint32_t* const frames = places.frame.data();
  uint8_t* const is_met = met.data();
  const Time time = camera_.times[camera];
  for (const Glancing& glancing : glances_)
    for (size_t i = rows.begin; i < rows.end; ++i) {
      const uint32_t thing = snapshots[i];
      const Glance glance = glance_at(glancing.planes, positions + 3 * i);
      const bool is_meant = (frames[i] == glancing.frame) & is_sighted(time, thing);
      is_met[thing] |= static_cast<uint8_t>(is_meant & (glance == Glance::kInside));
      if (glance != Glance::kUnsure || !is_meant) continue;
      ENGRAM_ASSIGN_OR_RETURN(const bool is_seen, is_in_view(camera, {i, i + 1}, false));
      is_met[thing] |= static_cast<uint8_t>(is_seen);
    }
  return {};
}

Result<bool> Looking::holds(uint32_t camera, uint32_t thing) {
  if (!is_sighted(camera_.times[camera], thing)) return false;
  find_linked_instances(thing);
  ENGRAM_RETURN_IF_ERROR(glance_with(camera));
  const RowCursor::Rows places = place_rows_.of(thing);
  const Glance glance = glance_at_places(places);
  if (glance != Glance::kUnsure) return glance == Glance::kInside;
  return is_in_view(camera, places, false);
}

Glance Looking::glance_at_places(RowCursor::Rows places) const {
  Glance all = Glance::kOutside;
  for (const Glancing& glancing : glances_) {
    if (!is_looked_with(glancing.instance)) continue;
    for (size_t i = places.begin; i < places.end; ++i) {
      if (thing_.places.frame[i] != glancing.frame) continue;
      const Glance one = glance_at(glancing.planes, &thing_.places.position[3 * i]);
      if (one == Glance::kInside) return one;
      if (one == Glance::kUnsure) all = one;
    }
  }
  return all;
}

Status Looking::without_hidden(Met& met,
                               const std::function<std::pair<uint32_t, uint32_t>(uint32_t)>& pair) {
  if (sighting_ != Sighting::kInVain || std::ranges::find(met, 1) == met.end()) return {};
  ENGRAM_ASSIGN_OR_RETURN(const bool has_depths, contexts_.has_depths(camera_id_));
  for (uint32_t i = 0; i < met.size() && has_depths; ++i) {
    if (met[i] == 0) continue;
    const auto [camera, thing] = pair(i);
    find_linked_instances(thing);
    ENGRAM_ASSIGN_OR_RETURN(const bool is_met, is_in_view(camera, place_rows_.of(thing), true));
    met[i] = is_met ? 1 : 0;
  }
  return {};
}

Result<bool> Looking::is_in_view(uint32_t camera, RowCursor::Rows places, bool must_be_free) {
  if (camera != looking_) ENGRAM_RETURN_IF_ERROR(look_with(camera));
  for (const Eye& eye : eyes_) {
    if (!is_looked_with(eye.instance)) continue;
    for (size_t i = places.begin; i < places.end; ++i) {
      if (thing_.places.frame[i] != eye.frame) continue;
      const Projection at = project(eye, i);
      if (!at.is_in_image) continue;
      if (!must_be_free) return true;
      ENGRAM_ASSIGN_OR_RETURN(const bool hidden, is_hidden(eye, camera, at));
      if (!hidden) return true;
    }
  }
  return false;
}

Result<bool> Looking::is_hidden(const Eye& eye, uint32_t camera, const Projection& at) {
  const MemoryId image = camera_id_.at(camera_.times[camera]).instance(eye.instance);
  ENGRAM_ASSIGN_OR_RETURN(const auto hidden,
                          contexts_.is_hidden(image, (at.u + 0.5) / eye.intrinsics.width,
                                              (at.v + 0.5) / eye.intrinsics.height, at.z));
  return hidden.value_or(false);
}

bool Looking::was_linked_near(Time image) {
  const uint32_t last = seen_times_.last_until(image);
  if (last != kNoRow && image - seen_at_[last] <= kSeenTolerance) return true;
  const size_t next = last == kNoRow ? 0 : size_t{last} + 1;
  return next < seen_at_.size() && seen_at_[next] - image <= kSeenTolerance;
}

uint32_t Looking::camera_of(uint32_t thing) {
  const RowCursor::Rows links = link_rows_.of(thing);
  for (size_t i = links.begin; i < links.end; ++i) {
    if (!is_of_image(i)) continue;
    // Many things are found in one image.
    const Time image = time_from_ns(thing_.links.time[i]);
    if (last_linked_ != kNoRow && camera_.times[last_linked_] == image) return last_linked_;
    if (const uint32_t found = camera_times_.at(image); found != kNoRow)
      return last_linked_ = found;
  }
  return camera_times_.last_until(thing_.times[thing]);
}

bool Looking::is_of_image(size_t link) const {
  return thing_.links.target[link] == target_ &&
         thing_.links.time[link] != EntityContext::Links::kNoTime;
}

void Looking::find_linked_instances(uint32_t thing) {
  linked_.clear();
  if (target_ == kNoRow || sighting_ == Sighting::kAny) return;
  const RowCursor::Rows links = link_rows_.of(thing);
  for (size_t i = links.begin; i < links.end; ++i)
    if (thing_.links.target[i] == target_ &&
        thing_.links.index[i] != EntityContext::Links::kNoInstance)
      linked_.push_back(thing_.links.index[i]);
}

// Which of several cameras a thing is seen with is told by its link to the image.
bool Looking::is_looked_with(int32_t instance) const {
  return linked_.empty() || std::ranges::find(linked_, instance) != linked_.end();
}

// A camera without intrinsics or without a frame of the thing sees nothing.
Status Looking::glance_with(uint32_t camera) {
  if (camera == glancing_) return {};
  glancing_ = camera;
  glances_.clear();
  const RowCursor::Rows rows = camera_rows_.of(camera);
  for (size_t row = rows.begin; row < rows.end; ++row) {
    const uint32_t frame = frames_[camera_.cameras.frame[row]];
    if (frame == kNoRow) continue;
    ENGRAM_ASSIGN_OR_RETURN(const Lens* const lens, lens_of(row));
    if (lens == nullptr) continue;
    glances_.push_back({turned(lens->planes, &camera_.cameras.position[3 * row],
                               &camera_.cameras.orientation[4 * row]),
                        frame, camera_.cameras.instance[row]});
  }
  return {};
}

Status Looking::look_with(uint32_t camera) {
  looking_ = camera;
  eyes_.clear();
  const RowCursor::Rows rows = look_rows_.of(camera);
  for (size_t row = rows.begin; row < rows.end; ++row) {
    Eye eye;
    eye.instance = camera_.cameras.instance[row];
    eye.frame = frames_[camera_.cameras.frame[row]];
    const double* q = &camera_.cameras.orientation[4 * row];
    const Eigen::Quaterniond orientation(q[0], q[1], q[2], q[3]);
    if (eye.frame == kNoRow || orientation.squaredNorm() == 0) continue;
    ENGRAM_ASSIGN_OR_RETURN(const Lens* const lens, lens_of(row));
    if (lens == nullptr) continue;
    Eigen::Map<Eigen::Matrix3d>(eye.to_camera.data()) =
        orientation.normalized().conjugate().toRotationMatrix();
    std::copy_n(&camera_.cameras.position[3 * row], 3, eye.position.begin());
    eye.intrinsics = lens->intrinsics;
    eyes_.push_back(eye);
  }
  return {};
}

// Null if the camera has none there. Valid as long as this object.
Result<const Looking::Lens*> Looking::lens_of(size_t row) {
  const int32_t calibration = camera_.cameras.calibration[row];
  if (calibration < 0) return &own_lenses_[static_cast<size_t>(-1 - calibration)];
  const auto link = static_cast<size_t>(calibration);
  const auto key =
      std::tuple(camera_.links.target[link], camera_.links.time[link], camera_.links.index[link]);
  auto known = linked_lenses_.find(key);
  if (known == linked_lenses_.end()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto read, contexts_.intrinsics(camera_.link(link)));
    std::optional<Lens> lens;
    if (read) lens = Lens{*read, planes_of(*read)};
    known = linked_lenses_.emplace(key, lens).first;
  }
  return known->second ? &*known->second : nullptr;
}

Looking::Projection Looking::project(const Eye& eye, size_t place) const {
  const Eigen::Vector3d seen = Eigen::Map<const Eigen::Matrix3d>(eye.to_camera.data()) *
                               (Eigen::Vector3d(&thing_.places.position[3 * place]) -
                                Eigen::Map<const Eigen::Vector3d>(eye.position.data()));
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

}  // namespace engram::ltm
