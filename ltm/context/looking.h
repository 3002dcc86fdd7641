// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: a camera and what it looks at.

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "ltm/context/cursors.h"
#include "ltm/context/meeting.h"
#include "ltm/context/view_planes.h"

namespace engram::ltm {

/// A camera and something with places: which of their snapshots are what is asked for.
///
/// Nearly all is told by glances, in floats. What they are not sure of, and what depth images are
/// asked about, is projected in doubles: the answer is that of the doubles.
///
/// Threading: one thread. What it is made of must outlive it.
class Looking {
 public:
  using Sighting = where::InView::Sighting;
  using Visibility = EntityContext::Visibility;

  Looking(const MemoryId& camera, const EntityContext& camera_context, const MemoryId& thing,
          const EntityContext& thing_context, Sighting sighting, KnownContexts& contexts);
  Looking(const Looking&) = delete;
  Looking& operator=(const Looking&) = delete;

  /// Errors: kFailedPrecondition if it cannot be told whether the thing was seen.
  [[nodiscard]] Status check() const;

  /// Which snapshots of the camera have the thing in view, as it was then.
  /// Errors: those of the contexts.
  Result<Met> images_of_thing();

  /// Which snapshots of the thing are in view of the camera: in the image that they link to, or
  /// else in the last one until then.
  /// Errors: those of the contexts.
  Result<Met> things_in_images();

 private:
  /// One camera of a snapshot, ready for a glance.
  struct Glancing {
    ViewPlanes planes;
    uint32_t frame = kNoRow;  ///< Among those of the thing.
    int32_t instance = 0;
  };
  /// The same, ready to project.
  struct Eye {
    int32_t instance = 0;
    uint32_t frame = kNoRow;
    std::array<double, 9> to_camera{};  ///< A rotation, column by column.
    std::array<double, 3> position{};   ///< Unit: m.
    Intrinsics intrinsics;
  };
  /// A place in an image. Unit: pixels, and m along the optical axis.
  struct Projection {
    double u = 0, v = 0, z = 0;
    bool is_in_image = false;
  };
  struct Lens {
    Intrinsics intrinsics;
    LensPlanes planes;
  };

  /// Images from `first` to before `last`, and the snapshots of the thing that belong to them, from
  /// `begin` to before `end`.
  struct Scope {
    uint32_t first = 0, last = 0;
    uint32_t begin = 0, end = 0;
  };
  static constexpr uint32_t kSmallScope = 32;  ///< Images.

  /// Finds what is in view in all images, of which no links tell the things.
  Status judge_images(Met& met);
  /// The same in some of them: at once if that can be told, or else in each half.
  Status judge(const Scope& scope, Met& met);
  /// The same in each image. `is_inside`: all places are known to be in view.
  Status judge_each(const Scope& scope, bool is_inside, Met& met);
  /// The same in one image, of the places that belong to it.
  Status judge_image(uint32_t camera, RowCursor::Rows rows, Met& met);
  /// Finds which images have the thing in view.
  Status judge_cameras(Met& met);
  Status judge_cameras(const Scope& scope, Met& met);
  /// Finds what is in view in the images that the things link to.
  Status judge_linked(Met& met);
  void find_runs();
  /// Whether all images of a scope have all its places in view, or none has one of them.
  Result<Glance> glance_at_all(const Scope& scope);
  /// Whether each image is looked at alone: there are few of them, or nothing was told of many
  /// small scopes before. Places may be anywhere at any time; a scope now and then is still tried.
  bool are_looked_at_alone(const Scope& scope);
  /// Whether a snapshot of the camera and one of the thing are what is asked for, but for what may
  /// be hidden.
  Result<bool> holds(uint32_t camera, uint32_t thing);
  [[nodiscard]] Glance glance_at_places(RowCursor::Rows places) const;

  /// What is known to be hidden was not looked for in vain: takes that away. `pair` gives the
  /// snapshots of the camera and of the thing that a row is about.
  Status without_hidden(Met& met,
                        const std::function<std::pair<uint32_t, uint32_t>(uint32_t)>& pair);
  /// Whether one of the places is in the image, in doubles. `must_be_free`: and depth images do not
  /// say that something was before it.
  Result<bool> is_in_view(uint32_t camera, RowCursor::Rows places, bool must_be_free);
  Result<bool> is_hidden(const Eye& eye, uint32_t camera, const Projection& at);

  /// Whether a snapshot of the thing was seen at the time of an image, or not, as it is asked for.
  [[nodiscard]] bool is_sighted(Time image, uint32_t thing) {
    if (sighting_ == Sighting::kAny) return true;
    const auto told = visibility_ == nullptr ? Visibility::kUntold : visibility_[thing];
    const bool was_seen =
        told == Visibility::kUntold ? was_linked_near(image) : told == Visibility::kVisible;
    return was_seen == (sighting_ == Sighting::kSeen);
  }
  [[nodiscard]] bool was_linked_near(Time image);
  [[nodiscard]] uint32_t camera_of(uint32_t thing);
  [[nodiscard]] bool is_of_image(size_t link) const;
  void find_linked_instances(uint32_t thing);
  [[nodiscard]] bool is_looked_with(int32_t instance) const;

  Status glance_with(uint32_t camera);
  Status look_with(uint32_t camera);
  Result<const Lens*> lens_of(size_t row);
  [[nodiscard]] Projection project(const Eye& eye, size_t place) const;

  const MemoryId& camera_id_;
  const EntityContext& camera_;
  const MemoryId& thing_id_;
  const EntityContext& thing_;
  const Sighting sighting_;
  KnownContexts& contexts_;
  const ContextRuns* camera_runs_ = nullptr;  ///< Null if they tell nothing of use.
  const ContextRuns* thing_runs_ = nullptr;
  uint32_t unsure_ = 0;                 ///< Small scopes in a row that nothing was told of.
  uint32_t skipped_ = 0;                ///< Those that were not looked at because of that.
  const Visibility* const visibility_;  ///< Of the thing; null if none of its snapshots tells.
  RowCursor camera_rows_, look_rows_, place_rows_, link_rows_;
  uint32_t last_linked_ = kNoRow;  ///< The image that was linked to last.
  uint32_t target_ = kNoRow;       ///< The camera among what the thing links to; kNoRow: not there.
  std::vector<uint32_t> frames_;   ///< Of each frame of the camera the index among the thing's.
  std::vector<Time> seen_at_;  ///< Times of the images that the thing links to, sorted; if asked.
  TimeCursor camera_times_, thing_times_, seen_times_;
  std::vector<int32_t> linked_;  ///< The instances that the thing links to; empty: it names none.
  uint32_t glancing_ = kNoRow;   ///< The snapshot that `glances_` are of.
  uint32_t looking_ = kNoRow;    ///< The snapshot that `eyes_` are of.
  std::vector<Glancing> glances_;
  std::vector<Eye> eyes_;
  std::vector<Lens> own_lenses_;  ///< Of the intrinsics of the camera.
  /// Of what its calibrations link to; nothing if there are no intrinsics.
  std::map<std::tuple<uint32_t, int64_t, int32_t>, std::optional<Lens>> linked_lenses_;
};

}  // namespace engram::ltm
