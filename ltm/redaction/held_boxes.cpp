// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/held_boxes.h"

#include <algorithm>

namespace engram::ltm {

namespace {

/// The time between two times, which may be the first and the last there are.
uint64_t ns_between(Time a, Time b) {
  const int64_t low = to_ns(std::min(a, b));
  const int64_t high = to_ns(std::max(a, b));
  return static_cast<uint64_t>(high) - static_cast<uint64_t>(low);
}

bool is_within(Time a, Time b, Duration hold) {
  return ns_between(a, b) <= static_cast<uint64_t>(hold.count());
}

bool is_in_any(const std::vector<RelativeBox>& boxes, const RelativeBox& box) {
  return std::ranges::any_of(boxes, [&](const RelativeBox& each) { return each.contains(box); });
}

}  // namespace

std::vector<RelativeBox> HeldBoxes::hold(const ImagePlace& place, Time time, Duration hold,
                                         const std::vector<RelativeBox>& seen) {
  std::erase_if(boxes_, [&](const Held& held) {
    return held.seen < time && !is_within(held.seen, time, hold);
  });
  std::vector<RelativeBox> holding;
  for (const Held& held : boxes_)
    if (held.place == place && is_within(held.seen, time, hold) && !is_in_any(seen, held.box))
      holding.push_back(held.box);
  if (hold > Duration(0))
    for (const RelativeBox& box : seen) boxes_.push_back({place, box, time});
  while (boxes_.size() > kMax) boxes_.pop_front();
  return holding;
}

bool HeldBoxes::is_over(Time time, Duration hold) const {
  return std::ranges::all_of(boxes_, [&](const Held& held) {
    return held.seen < time && !is_within(held.seen, time, hold);
  });
}

}  // namespace engram::ltm
