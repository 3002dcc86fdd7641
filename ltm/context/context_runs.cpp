// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/context_runs.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "ltm/context/entity_context.h"

namespace engram::ltm {

namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

float below(double number) {
  const auto rounded = static_cast<float>(number);
  if (std::isnan(rounded)) return -kInfinite;
  return static_cast<double>(rounded) <= number ? rounded : std::nextafter(rounded, -kInfinite);
}

float above(double number) {
  const auto rounded = static_cast<float>(number);
  if (std::isnan(rounded)) return kInfinite;
  return static_cast<double>(rounded) >= number ? rounded : std::nextafter(rounded, kInfinite);
}

template <size_t W>
void widen(typename RunBounds<W>::Bounds& bounds, const typename RunBounds<W>::Bounds& more) {
  for (size_t i = 0; i < W; ++i) {
    bounds.low[i] = std::min(bounds.low[i], more.low[i]);
    bounds.high[i] = std::max(bounds.high[i], more.high[i]);
  }
}

/// The rotation of a quaternion of any length, row by row; numbers that are not finite if it is
/// none.
std::array<double, 9> rotation_of(const double* q) {
  const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const double s = 2 / square;
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  return {1 - s * (y * y + z * z), s * (x * y - w * z),     s * (x * z + w * y),
          s * (x * y + w * z),     1 - s * (x * x + z * z), s * (y * z - w * x),
          s * (x * z - w * y),     s * (y * z + w * x),     1 - s * (x * x + y * y)};
}

std::optional<uint32_t> common(const std::vector<uint32_t>& column) {
  if (column.empty() || std::ranges::any_of(column, [&](uint32_t v) { return v != column[0]; }))
    return std::nullopt;
  return column[0];
}

/// Whether two cameras have the same intrinsics, or link to the same ones.
bool have_one_lens(const EntityContext& context, int32_t one, int32_t other) {
  if (one < 0 || other < 0) return one == other;
  const auto& links = context.links;
  const auto i = static_cast<size_t>(one);
  const auto j = static_cast<size_t>(other);
  return links.target[i] == links.target[j] && links.time[i] == links.time[j] &&
         links.index[i] == links.index[j];
}

/// How many rows each of `count` snapshots has; 0 if some have more than others.
size_t rows_each(const std::vector<uint32_t>& snapshots, size_t count) {
  if (count == 0 || snapshots.size() % count != 0) return 0;
  const size_t each = snapshots.size() / count;
  for (size_t i = 0; i < snapshots.size(); ++i)
    if (snapshots[i] != i / each) return 0;
  return each;
}

}  // namespace

template <size_t W>
void RunBounds<W>::add(const std::array<double, W>& row) {
  Bounds one;
  for (size_t i = 0; i < W; ++i) {
    one.low[i] = below(row[i]);
    one.high[i] = above(row[i]);
  }
  if (levels_.empty()) levels_.emplace_back();
  if (rows_++ % kRun == 0)
    levels_[0].push_back(one);
  else
    widen<W>(levels_[0].back(), one);
}

template <size_t W>
void RunBounds<W>::finish() {
  while (!levels_.empty() && levels_.back().size() > 1) {
    const std::vector<Bounds>& shorter = levels_.back();
    std::vector<Bounds> longer;
    longer.reserve((shorter.size() + 1) / 2);
    for (size_t i = 0; i < shorter.size(); ++i)
      if (i % 2 == 0)
        longer.push_back(shorter[i]);
      else
        widen<W>(longer.back(), shorter[i]);
    levels_.push_back(std::move(longer));
  }
}

template <size_t W>
size_t RunBounds<W>::held_bytes() const {
  size_t bytes = 0;
  for (const auto& level : levels_) bytes += level.capacity() * sizeof(Bounds);
  return bytes;
}

// The longest runs of which four at most cover the range: longer ones would bound more of what is
// beside it.
template <size_t W>
typename RunBounds<W>::Bounds RunBounds<W>::of(size_t begin, size_t end) const {
  const size_t length = (end - 1) / kRun - begin / kRun + 1;
  const size_t level = length <= 3 ? 0 : std::bit_width((length - 1) / 3);
  const std::vector<Bounds>& runs = levels_[std::min(level, levels_.size() - 1)];
  const size_t run = kRun << std::min(level, levels_.size() - 1);
  const size_t last = (end - 1) / run;
  Bounds bounds = runs[begin / run];
  for (size_t i = begin / run + 1; i <= last; ++i) widen<W>(bounds, runs[i]);
  return bounds;
}

template class RunBounds<3>;
template class RunBounds<12>;

ContextRuns::ContextRuns(const EntityContext& context) {
  const auto& found = context.places;
  for (size_t i = 0; i < found.size(); ++i) {
    const double* at = &found.position[3 * i];
    places.add({at[0], at[1], at[2]});
  }
  places.finish();
  place_frame = common(found.frame);
  places_each = rows_each(found.snapshot, context.times.size());
  const auto& seeing = context.cameras;
  for (size_t i = 0; i < seeing.size(); ++i) {
    const std::array<double, 9> r = rotation_of(&seeing.orientation[4 * i]);
    const double* at = &seeing.position[3 * i];
    cameras.add({r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], at[0], at[1], at[2]});
  }
  cameras.finish();
  camera_frame = common(seeing.frame);
  if (seeing.size() > 0 && std::ranges::all_of(seeing.calibration, [&](int32_t one) {
        return have_one_lens(context, seeing.calibration[0], one);
      }))
    lens_row = 0;
  cameras_each = rows_each(seeing.snapshot, context.times.size());
}

bool ContextRuns::is_of(const EntityContext& context) const {
  return places.rows() == context.places.size() && cameras.rows() == context.cameras.size();
}

}  // namespace engram::ltm
