// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/sight.h"

#include <algorithm>

namespace engram::ltm {

namespace {

/// Whether `next`, which begins no earlier, begins in `window` or directly after it.
bool touches(const TimeWindows::Window& window, const TimeWindows::Window& next) {
  return to_ns(window.last) == INT64_MAX || to_ns(next.first) <= to_ns(window.last) + 1;
}

}  // namespace

TimeWindows TimeWindows::all() {
  TimeWindows windows;
  windows.add({});
  return windows;
}

void TimeWindows::add(const Window& window) {
  if (window.last < window.first) return;
  windows_.insert(std::ranges::upper_bound(windows_, window.first, {}, &Window::first), window);
  std::vector<Window> joined;
  for (const Window& next : windows_) {
    if (!joined.empty() && touches(joined.back(), next))
      joined.back().last = std::max(joined.back().last, next.last);
    else
      joined.push_back(next);
  }
  windows_ = std::move(joined);
}

bool TimeWindows::is_all() const {
  return windows_.size() == 1 && windows_.front() == Window{};
}

bool TimeWindows::contains(Time time) const {
  return std::ranges::any_of(windows_, [time](const Window& window) {
    return window.first <= time && time <= window.last;
  });
}

Sight sight_of(const View* view, const MemoryId& entity) {
  return view == nullptr ? Sight{TimeWindows::all(), TimeWindows::all(), true} : view->of(entity);
}

}  // namespace engram::ltm
