// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/window_buffer.h"

#include <algorithm>

#include "ltm/filter/saturated_time.h"

namespace engram::ltm {

void WindowBuffer::add(Candidate candidate, bool is_wanted) {
  const Time time = candidate.snapshot.time;
  newest_ = std::max(newest_, time);
  held_bytes_ += candidate.raw_bytes;
  queue_.push_back({std::move(candidate), is_wanted || is_open_at(time)});
}

void WindowBuffer::mark(Time time) {
  const Window made{saturated_add(time, -options_.before),
                    options_.after ? saturated_add(time, *options_.after) : Time::max()};
  const bool is_past = window_ && window_->last < newest_ && window_->last < made.first;
  if (!window_ || is_past)
    window_ = made;
  else
    window_ = Window{std::min(window_->first, made.first), std::max(window_->last, made.last)};
  for (Held& held : queue_)
    if (is_open_at(held.candidate.snapshot.time)) held.is_wanted = true;
}

bool WindowBuffer::is_open_at(Time time) const {
  return window_ && time >= window_->first && time <= window_->last;
}

void WindowBuffer::settle(FilterDecisions& decisions) {
  const Time oldest = saturated_add(newest_, -options_.before);
  const auto is_over = [this] {
    return held_bytes_ + queue_.size() * kHeldOverheadBytes > options_.max_held_bytes;
  };
  while (!queue_.empty()) {
    const Held& front = queue_.front();
    const bool is_old = front.candidate.snapshot.time < oldest;
    if (!front.is_wanted && !is_old && !is_over()) return;
    pop(is_old ? options_.reason : "hold limit", decisions);
  }
}

void WindowBuffer::flush(FilterDecisions& decisions) {
  while (!queue_.empty()) pop(options_.reason, decisions);
}

void WindowBuffer::add_held_times(TimeSet& times) const {
  for (const Held& held : queue_) times.insert(held.candidate.snapshot.time);
}

void WindowBuffer::forget(const TimeSet& times, FilterDecisions& decisions) {
  std::erase_if(queue_, [&](const Held& held) {
    if (!times.contains(held.candidate.snapshot.time)) return false;
    held_bytes_ -= held.candidate.raw_bytes;
    decisions.drop(Filter::kForgotten, held.candidate);
    return true;
  });
}

void WindowBuffer::pop(std::string_view reason, FilterDecisions& decisions) {
  Held& front = queue_.front();
  held_bytes_ -= front.candidate.raw_bytes;
  if (front.is_wanted)
    decisions.keep(std::move(front.candidate));
  else
    decisions.drop(reason, front.candidate);
  queue_.pop_front();
}

}  // namespace engram::ltm
