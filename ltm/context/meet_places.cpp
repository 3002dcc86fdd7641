// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <utility>

#include "ltm/context/meeting.h"

namespace engram::ltm {

namespace {

/// The squared distance of two points. Unit: m squared.
double squared_distance(const double* a, const double* b) {
  const double x = a[0] - b[0];
  const double y = a[1] - b[1];
  const double z = a[2] - b[2];
  return x * x + y * y + z * z;
}

constexpr uint32_t kNoFrame = UINT32_MAX;

uint32_t frame_of(const EntityContext& context, std::string_view name) {
  const auto found = std::ranges::find(context.frames, name);
  return found == context.frames.end() ? kNoFrame
                                       : static_cast<uint32_t>(found - context.frames.begin());
}

/// For each frame of `one` its index in `other`; kNoFrame if the other has no such frame. What
/// names no frame is in no frame.
std::vector<uint32_t> shared_frames(const EntityContext& one, const EntityContext& other) {
  std::vector<uint32_t> shared;
  shared.reserve(one.frames.size());
  for (const std::string& frame : one.frames)
    shared.push_back(frame.empty() ? kNoFrame : frame_of(other, frame));
  return shared;
}

/// Which places are near a point: those of a run at once, if that can be told, or else of each
/// half.
class NearPoint {
 public:
  NearPoint(const EntityContext& context, const where::Near& near, uint32_t frame)
      : places_(context.places),
        point_(near.point),
        frame_(frame),
        limit_(near.metres * near.metres) {
    const auto& runs = context.runs.found;
    if (runs != nullptr && runs->is_of(context) && runs->place_frame == frame)
      bounds_ = &runs->places;
  }

  void judge(size_t begin, size_t end, Met& met) const {
    constexpr size_t kFew = 128;
    if (bounds_ == nullptr || end - begin <= kFew) {
      for (size_t i = begin; i < end; ++i)
        if (squared_distance(&places_.position[3 * i], point_.data()) <= limit_ &&
            places_.frame[i] == frame_)
          met[places_.snapshot[i]] = 1;
      return;
    }
    const auto [nearest, farthest] = distances(bounds_->of(begin, end));
    if (nearest > limit_ * (1 + kRounding)) return;
    if (farthest < limit_ * (1 - kRounding)) {
      for (size_t i = begin; i < end; ++i) met[places_.snapshot[i]] = 1;
      return;
    }
    const size_t half = begin + (end - begin) / 2;
    judge(begin, half, met);
    judge(half, end, met);
  }

 private:
  static constexpr double kRounding = 1e-12;

  /// The smallest and the largest squared distance from a box. Unit: m squared.
  [[nodiscard]] std::pair<double, double> distances(const RunBounds<3>::Bounds& box) const {
    double nearest = 0;
    double farthest = 0;
    for (size_t i = 0; i < 3; ++i) {
      const double below = static_cast<double>(box.low[i]) - point_[i];
      const double above = point_[i] - static_cast<double>(box.high[i]);
      const double out = std::max({below, above, 0.0});
      const double in = std::max(-below, -above);
      nearest += out * out;
      farthest += in * in;
    }
    return {nearest, farthest};
  }

  const EntityContext::Places& places_;
  const std::array<double, 3> point_;
  const uint32_t frame_;
  const double limit_;
  const RunBounds<3>* bounds_ = nullptr;  ///< Null if they tell nothing of use.
};

}  // namespace

std::string frames_of(const EntityContext& context) {
  std::string text;
  for (const std::string& frame : context.frames)
    if (!frame.empty()) text += (text.empty() ? "'" : ", '") + frame + "'";
  return text;
}

Status no_place(const MemoryId& entity, const EntityContext& context, std::string_view frame) {
  const std::string frames = frames_of(context);
  if (context.places.size() == 0)
    return failed_precondition(
        "'{}' has no place: needs a pose in a member named pose_FRAME_THING, or with a 'frame_id'",
        entity.to_string());
  if (frames.empty())
    return failed_precondition(
        "'{}' has poses that name no frame: needs a member named pose_FRAME_THING, or a 'frame_id'",
        entity.to_string());
  return failed_precondition("'{}' has no place in frame '{}'; it has places in {}",
                             entity.to_string(), frame, frames);
}

Result<Met> meet_near(const Asked& asked, const where::Near& near) {
  const auto& places = asked.context.places;
  Met met(asked.context.times.size(), 0);
  const uint32_t frame = frame_of(asked.context, near.frame);
  if (frame == kNoFrame) {
    if (asked.is_named) return no_place(asked.id, asked.context, near.frame);
    return met;
  }
  NearPoint(asked.context, near, frame).judge(0, places.size(), met);
  return met;
}

Result<Met> meet_within(const Asked& asked, const where::Within& within,
                        const EntityContext& other) {
  const auto& places = asked.context.places;
  Met met(asked.context.times.size(), 0);
  const std::vector<uint32_t> frames = shared_frames(asked.context, other);
  if (std::ranges::all_of(other.frames, [](const std::string& f) { return f.empty(); }))
    return no_place(within.entity, other, "");
  if (std::ranges::all_of(frames, [](uint32_t frame) { return frame == kNoFrame; })) {
    if (!asked.is_named) return met;
    if (frames_of(asked.context).empty()) return no_place(asked.id, asked.context, "");
    return failed_precondition("'{}' and '{}' have no frame in common: places are in {} and in {}",
                               asked.id.to_string(), within.entity.to_string(),
                               frames_of(asked.context), frames_of(other));
  }
  const double limit = within.metres * within.metres;
  // The rows of the other one as it was then: those of its last snapshot until then.
  uint32_t latest = 0;  // One behind it.
  size_t first = 0;
  size_t last = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    const Time time = asked.context.times[places.snapshot[i]];
    if (latest < other.times.size() && other.times[latest] <= time) {
      while (latest < other.times.size() && other.times[latest] <= time) ++latest;
      while (first < other.places.size() && other.places.snapshot[first] + 1 < latest) ++first;
      last = first;
      while (last < other.places.size() && other.places.snapshot[last] + 1 == latest) ++last;
    }
    for (size_t j = first; j < last; ++j)
      if (frames[places.frame[i]] == other.places.frame[j] &&
          squared_distance(&places.position[3 * i], &other.places.position[3 * j]) <= limit)
        met[places.snapshot[i]] = 1;
  }
  return met;
}

}  // namespace engram::ltm
