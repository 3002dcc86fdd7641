// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/entity_context.h"

#include <algorithm>
#include <numeric>

namespace engram::ltm {

namespace {

template <typename T>
size_t bytes_of(const std::vector<T>& column) {
  return column.capacity() * sizeof(T);
}

/// Lenses that are compared; more would take a time that is quadratic in their number.
constexpr size_t kComparedLenses = 16;

void copy_cells(const std::vector<double>& from, size_t row, size_t width,
                std::vector<double>& to) {
  const auto first = from.begin() + static_cast<ptrdiff_t>(row * width);
  to.insert(to.end(), first, first + static_cast<ptrdiff_t>(width));
}

}  // namespace

size_t EntityContext::held_bytes() const {
  return sizeof(*this) + bytes_of(times) + bytes_of(visibility) + bytes_of(places.snapshot) +
         bytes_of(places.frame) + bytes_of(places.position) + bytes_of(cameras.snapshot) +
         bytes_of(cameras.instance) + bytes_of(cameras.frame) + bytes_of(cameras.position) +
         bytes_of(cameras.orientation) + bytes_of(cameras.calibration) + bytes_of(links.snapshot) +
         bytes_of(links.instance) + bytes_of(links.target) + bytes_of(links.time) +
         bytes_of(links.index) + bytes_of(spans.snapshot) + bytes_of(spans.started) +
         bytes_of(spans.ended) + bytes_of(frames) + bytes_of(intrinsics) + bytes_of(targets) +
         (runs.found ? runs.found->held_bytes() : 0);
}

void EntityContext::find_runs() {
  const bool are_many =
      places.size() >= ContextRuns::kMinRows || cameras.size() >= ContextRuns::kMinRows;
  runs.found = are_many ? std::make_shared<const ContextRuns>(*this) : nullptr;
}

MemoryId EntityContext::link(size_t row) const {
  MemoryId id = targets[links.target[row]];
  if (links.time[row] == Links::kNoTime) return id;
  id = id.at(time_from_ns(links.time[row]));
  return links.index[row] < 0 ? id : id.instance(links.index[row]);
}

std::optional<uint32_t> EntityContext::find(Time time) const {
  const auto found = std::ranges::lower_bound(times, time);
  if (found == times.end() || *found != time) return std::nullopt;
  return static_cast<uint32_t>(found - times.begin());
}

size_t first_row(const std::vector<uint32_t>& snapshots, uint32_t snapshot) {
  return static_cast<size_t>(std::ranges::lower_bound(snapshots, snapshot) - snapshots.begin());
}

uint32_t index_of_lens(std::vector<Intrinsics>& known, const Intrinsics& lens) {
  const size_t end = known.size() > kComparedLenses ? known.size() - kComparedLenses : 0;
  for (size_t i = known.size(); i > end; --i)
    if (known[i - 1] == lens) return static_cast<uint32_t>(i - 1);
  known.push_back(lens);
  return static_cast<uint32_t>(known.size() - 1);
}

ContextMerger::Source& ContextMerger::source_of(const EntityContext& from) {
  if (last_ < sources_.size() && sources_[last_].from == &from) return sources_[last_];
  for (last_ = 0; last_ < sources_.size(); ++last_)
    if (sources_[last_].from == &from) return sources_[last_];
  Source source;
  source.from = &from;
  for (const std::string& frame : from.frames)
    source.frames.push_back(frames_.of(frame, merged_.frames));
  for (const Intrinsics& lens : from.intrinsics)
    source.intrinsics.push_back(index_of_lens(merged_.intrinsics, lens));
  for (const MemoryId& target : from.targets)
    source.targets.push_back(targets_.of(target, merged_.targets));
  sources_.push_back(std::move(source));
  return sources_.back();
}

void ContextMerger::add(const EntityContext& from, uint32_t snapshot) {
  Source& source = source_of(from);
  const auto to = static_cast<uint32_t>(merged_.times.size());
  merged_.times.push_back(from.times[snapshot]);
  if (!from.visibility.empty() || !merged_.visibility.empty()) {
    merged_.visibility.resize(merged_.times.size(), EntityContext::Visibility::kUntold);
    if (!from.visibility.empty()) merged_.visibility.back() = from.visibility[snapshot];
  }
  const auto& places = from.places;
  while (source.place < places.size() && places.snapshot[source.place] < snapshot) ++source.place;
  for (; source.place < places.size() && places.snapshot[source.place] == snapshot;
       ++source.place) {
    merged_.places.snapshot.push_back(to);
    merged_.places.frame.push_back(source.frames[places.frame[source.place]]);
    copy_cells(places.position, source.place, 3, merged_.places.position);
  }
  const auto& links = from.links;
  while (source.link < links.size() && links.snapshot[source.link] < snapshot) ++source.link;
  const size_t own_link = source.link;
  const size_t new_link = merged_.links.size();
  for (; source.link < links.size() && links.snapshot[source.link] == snapshot; ++source.link) {
    merged_.links.snapshot.push_back(to);
    merged_.links.instance.push_back(links.instance[source.link]);
    merged_.links.target.push_back(source.targets[links.target[source.link]]);
    merged_.links.time.push_back(links.time[source.link]);
    merged_.links.index.push_back(links.index[source.link]);
  }
  const auto& cameras = from.cameras;
  while (source.camera < cameras.size() && cameras.snapshot[source.camera] < snapshot)
    ++source.camera;
  for (; source.camera < cameras.size() && cameras.snapshot[source.camera] == snapshot;
       ++source.camera) {
    merged_.cameras.snapshot.push_back(to);
    merged_.cameras.instance.push_back(cameras.instance[source.camera]);
    merged_.cameras.frame.push_back(source.frames[cameras.frame[source.camera]]);
    const int32_t calibration = cameras.calibration[source.camera];
    merged_.cameras.calibration.push_back(
        calibration >= 0
            ? static_cast<int32_t>(new_link + (static_cast<size_t>(calibration) - own_link))
            : -1 - static_cast<int32_t>(source.intrinsics[static_cast<size_t>(-1 - calibration)]));
    copy_cells(cameras.position, source.camera, 3, merged_.cameras.position);
    copy_cells(cameras.orientation, source.camera, 4, merged_.cameras.orientation);
  }
  const auto& spans = from.spans;
  while (source.span < spans.size() && spans.snapshot[source.span] < snapshot) ++source.span;
  for (; source.span < spans.size() && spans.snapshot[source.span] == snapshot; ++source.span) {
    merged_.spans.snapshot.push_back(to);
    merged_.spans.started.push_back(spans.started[source.span]);
    merged_.spans.ended.push_back(spans.ended[source.span]);
  }
}

}  // namespace engram::ltm
