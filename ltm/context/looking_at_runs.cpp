// SPDX-License-Identifier: Apache-2.0
// What is in view, told of many images and places at once where that can be told.
#include <algorithm>
#include <array>

#include "ltm/context/looking.h"

namespace engram::ltm {

namespace {

/// The first of some snapshots that is not before a time.
uint32_t first_from(const std::vector<Time>& times, uint32_t begin, uint32_t end, Time time) {
  const auto found = std::lower_bound(times.begin() + begin, times.begin() + end, time);
  return static_cast<uint32_t>(found - times.begin());
}

/// The first of some snapshots that is after a time.
uint32_t first_after(const std::vector<Time>& times, uint32_t begin, uint32_t end, Time time) {
  const auto found = std::upper_bound(times.begin() + begin, times.begin() + end, time);
  return static_cast<uint32_t>(found - times.begin());
}

}  // namespace

// Runs of cameras that differ in more than where they are tell nothing of use.
void Looking::find_runs() {
  const auto runs_of = [](const EntityContext& context) {
    const auto& found = context.runs.found;
    return found != nullptr && found->is_of(context) ? found.get() : nullptr;
  };
  const ContextRuns* const cameras = runs_of(camera_);
  const ContextRuns* const things = runs_of(thing_);
  if (cameras == nullptr || things == nullptr) return;
  if (cameras->cameras_each == 0 || !cameras->lens_row || !cameras->camera_frame) return;
  if (things->places_each == 0 || !things->place_frame) return;
  if (frames_[*cameras->camera_frame] != *things->place_frame) return;
  camera_runs_ = cameras;
  thing_runs_ = things;
}

Result<Glance> Looking::glance_at_all(const Scope& scope) {
  if (camera_runs_ == nullptr) return Glance::kUnsure;
  ENGRAM_ASSIGN_OR_RETURN(const Lens* const lens, lens_of(*camera_runs_->lens_row));
  if (lens == nullptr) return Glance::kUnsure;
  const size_t cameras = camera_runs_->cameras_each;
  const size_t places = thing_runs_->places_each;
  const Glance all = glance_at_run(
      lens->planes, camera_runs_->cameras.of(scope.first * cameras, scope.last * cameras),
      thing_runs_->places.of(scope.begin * places, scope.end * places));
  if (all != Glance::kUnsure)
    unsure_ = 0;
  else if (scope.last - scope.first <= kSmallScope)
    ++unsure_;
  return all;
}

bool Looking::are_looked_at_alone(const Scope& scope) {
  constexpr uint32_t kFewImages = 4;
  constexpr uint32_t kPatience = 16;
  constexpr uint32_t kSkipped = 256;
  const uint32_t images = scope.last - scope.first;
  if (camera_runs_ == nullptr || images <= kFewImages) return true;
  return images <= kSmallScope && unsure_ >= kPatience && ++skipped_ % kSkipped != 0;
}

Status Looking::judge_images(Met& met) {
  if (camera_.times.empty()) return {};
  const auto images = static_cast<uint32_t>(camera_.times.size());
  const auto things = static_cast<uint32_t>(met.size());
  return judge({0, images, first_from(thing_.times, 0, things, camera_.times[0]), things}, met);
}

Status Looking::judge(const Scope& scope, Met& met) {
  if (scope.begin == scope.end) return {};
  if (are_looked_at_alone(scope)) return judge_each(scope, false, met);
  ENGRAM_ASSIGN_OR_RETURN(const Glance all, glance_at_all(scope));
  if (all == Glance::kOutside) return {};
  if (all == Glance::kInside) return judge_each(scope, true, met);
  const uint32_t half = scope.first + (scope.last - scope.first) / 2;
  const uint32_t middle = first_from(thing_.times, scope.begin, scope.end, camera_.times[half]);
  ENGRAM_RETURN_IF_ERROR(judge({scope.first, half, scope.begin, middle}, met));
  return judge({half, scope.last, middle, scope.end}, met);
}

// Without links the snapshots that belong to an image are those until the next one.
Status Looking::judge_each(const Scope& scope, bool is_inside, Met& met) {
  if (is_inside && sighting_ == Sighting::kAny) {
    std::fill(met.begin() + scope.begin, met.begin() + scope.end, 1);
    return {};
  }
  const auto& places = thing_.places;
  uint32_t end = scope.begin;
  size_t place = thing_runs_ != nullptr ? scope.begin * thing_runs_->places_each
                                        : first_row(places.snapshot, scope.begin);
  for (uint32_t image = scope.first; image < scope.last && end < scope.end; ++image) {
    const uint32_t begin = end;
    if (image + 1 == scope.last) end = scope.end;
    while (end < scope.end && thing_.times[end] < camera_.times[image + 1]) ++end;
    if (begin == end) continue;
    if (is_inside) {
      for (uint32_t thing = begin; thing < end; ++thing)
        met[thing] = is_sighted(camera_.times[image], thing) ? 1 : 0;
      continue;
    }
    const size_t first = place;
    while (place < places.size() && places.snapshot[place] < end) ++place;
    ENGRAM_RETURN_IF_ERROR(judge_image(image, {first, place}, met));
  }
  return {};
}

Status Looking::judge_cameras(Met& met) {
  const auto things = static_cast<uint32_t>(thing_.times.size());
  const auto images = static_cast<uint32_t>(met.size());
  if (things == 0 || images == 0) return {};
  const uint32_t first = first_from(camera_.times, 0, images, thing_.times[0]);
  if (first == images) return {};
  return judge_cameras(
      {first, images, first_after(thing_.times, 0, things, camera_.times[first]) - 1,
       first_after(thing_.times, 0, things, camera_.times.back())},
      met);
}

// The places of an image are those of the last snapshot until then.
Status Looking::judge_cameras(const Scope& scope, Met& met) {
  Glance all = Glance::kUnsure;
  const bool are_alone = are_looked_at_alone(scope);
  if (!are_alone) {
    ENGRAM_ASSIGN_OR_RETURN(all, glance_at_all(scope));
  }
  if (all == Glance::kOutside) return {};
  if (all == Glance::kInside && sighting_ == Sighting::kAny) {
    std::fill(met.begin() + scope.first, met.begin() + scope.last, 1);
    return {};
  }
  if (are_alone || all == Glance::kInside) {
    for (uint32_t image = scope.first; image < scope.last; ++image) {
      ENGRAM_ASSIGN_OR_RETURN(const bool is_met,
                              holds(image, thing_times_.last_until(camera_.times[image])));
      met[image] = is_met ? 1 : 0;
    }
    return {};
  }
  const uint32_t half = scope.first + (scope.last - scope.first) / 2;
  const uint32_t end = first_after(thing_.times, scope.begin, scope.end, camera_.times[half - 1]);
  const uint32_t begin = first_after(thing_.times, scope.begin, scope.end, camera_.times[half]) - 1;
  ENGRAM_RETURN_IF_ERROR(judge_cameras({scope.first, half, scope.begin, end}, met));
  return judge_cameras({half, scope.last, begin, scope.end}, met);
}

Status Looking::judge_linked(Met& met) {
  constexpr uint32_t kChunk = 64;
  constexpr uint32_t kMaxImages = 4 * kChunk;
  std::array<uint32_t, kChunk> images{};
  const auto count = static_cast<uint32_t>(met.size());
  for (uint32_t begin = 0; begin < count; begin += kChunk) {
    const uint32_t end = std::min(count, begin + kChunk);
    Scope scope{kNoRow, 0, begin, end};
    bool have_images = true;
    for (uint32_t thing = begin; thing < end; ++thing) {
      const uint32_t image = images[thing - begin] = camera_of(thing);
      have_images = have_images && image != kNoRow;
      scope.first = std::min(scope.first, image);
      scope.last = std::max(scope.last, image + 1);
    }
    Glance all = Glance::kUnsure;
    if (have_images && scope.last - scope.first <= kMaxImages && !are_looked_at_alone(scope)) {
      ENGRAM_ASSIGN_OR_RETURN(all, glance_at_all(scope));
    }
    if (all == Glance::kOutside) continue;
    if (all == Glance::kInside && sighting_ == Sighting::kAny) {
      std::fill(met.begin() + begin, met.begin() + end, 1);
      continue;
    }
    for (uint32_t thing = begin; thing < end; ++thing) {
      const uint32_t image = images[thing - begin];
      if (image == kNoRow) continue;
      ENGRAM_ASSIGN_OR_RETURN(const bool is_met, holds(image, thing));
      met[thing] = is_met ? 1 : 0;
    }
  }
  return {};
}

}  // namespace engram::ltm
