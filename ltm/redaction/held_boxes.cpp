// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/held_boxes.h"

#include <algorithm>
#include <tuple>

namespace engram::ltm {

namespace {

/// A box takes another one in as seen again if it is at most so much larger. Without this bound one
/// wrong box of the whole image would hold as long as anything is seen in it.
constexpr double kMaxTimesLarger = 2;

/// The time between two times, which may be the first and the last there are.
uint64_t ns_between(Time a, Time b) {
  const int64_t low = to_ns(std::min(a, b));
  const int64_t high = to_ns(std::max(a, b));
  return static_cast<uint64_t>(high) - static_cast<uint64_t>(low);
}

bool is_in_any(const std::vector<RelativeBox>& boxes, const RelativeBox& box) {
  return std::ranges::any_of(boxes, [&](const RelativeBox& each) { return each.contains(box); });
}

/// Whether nothing lies between the times in which two spans count.
bool do_touch(Time first, Time last, Time other_first, Time other_last, Duration hold) {
  const auto twice = 2 * static_cast<uint64_t>(hold.count());
  if (other_first > last) return ns_between(last, other_first) <= twice;
  if (other_last < first) return ns_between(other_last, first) <= twice;
  return true;
}

}  // namespace

bool HeldBoxes::Held::counts(Time time, Duration hold) const {
  const auto bound = static_cast<uint64_t>(hold.count());
  if (time < first) return ns_between(time, first) <= bound;
  if (time > last) return ns_between(last, time) <= bound;
  return true;
}

void HeldBoxes::begin(Time time, Duration hold) {
  for (Held& held : boxes_)
    held.missed = held.counts(time, hold) ? 0 : std::min(held.missed + 1, kPatience);
  std::erase_if(boxes_,
                [&](const Held& held) { return held.missed == kPatience && held.last < time; });
}

std::vector<RelativeBox> HeldBoxes::hold(const ImagePlace& place, Time time, Duration hold,
                                         const std::vector<RelativeBox>& seen) {
  std::vector<RelativeBox> holding;
  for (const Held& held : boxes_)
    if ((!held.place || *held.place == place) && held.counts(time, hold) &&
        !is_in_any(seen, held.box))
      holding.push_back(held.box);
  if (hold > Duration(0))
    for (const RelativeBox& box : seen) add(place, time, hold, box);
  return holding;
}

void HeldBoxes::add(const ImagePlace& place, Time time, Duration hold, const RelativeBox& box) {
  for (Held& held : boxes_)
    if (held.place == place && held.box.contains(box) &&
        held.box.area() <= kMaxTimesLarger * box.area() &&
        do_touch(held.first, held.last, time, time, hold)) {
      held.first = std::min(held.first, time);
      held.last = std::max(held.last, time);
      held.missed = 0;
      return;
    }
  boxes_.push_back({place, box, time, time});
  if (boxes_.size() <= max_) return;
  std::erase_if(boxes_, [](const Held& held) { return held.missed == kPatience; });
  while (boxes_.size() > max_) join_two(hold);
}

/// Joins the oldest box that has others in its image with the one that makes it grow least, if
/// possible one that counts at the same times. Where each image has one box, the oldest counts for
/// all images of the entity from then on.
void HeldBoxes::join_two(Duration hold) {
  for (size_t i = 0; i < boxes_.size(); ++i) {
    const Held& one = boxes_[i];
    size_t best = i;
    std::tuple<bool, double> smallest_growth;
    for (size_t k = i + 1; k < boxes_.size(); ++k) {
      const Held& other = boxes_[k];
      if (other.place != one.place) continue;
      const std::tuple growth{
          !do_touch(one.first, one.last, other.first, other.last, hold),
          hull(one.box, other.box).area() - std::max(one.box.area(), other.box.area())};
      if (best != i && growth >= smallest_growth) continue;
      best = k;
      smallest_growth = growth;
    }
    if (best == i) continue;
    Held& into = boxes_[best];
    into.box = hull(into.box, one.box);
    into.first = std::min(into.first, one.first);
    into.last = std::max(into.last, one.last);
    into.missed = std::min(into.missed, one.missed);
    boxes_.erase(boxes_.begin() + static_cast<ptrdiff_t>(i));
    return;
  }
  std::ranges::find_if(boxes_, [](const Held& held) {
    return held.place.has_value();
  })->place.reset();
}

}  // namespace engram::ltm
