// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

namespace engram::memory {

/// The events that wait for one subscriber. Beyond its bounds the oldest are dropped and counted.
///
/// Threading: one thread.
template <typename Event>
class EventQueue {
 public:
  struct Bounds {
    size_t events = 1024;
    size_t bytes = size_t{64} << 20;  ///< A single event may exceed it.
  };

  explicit EventQueue(const Bounds& bounds) : bounds_(bounds) {}

  void push(Event event, size_t bytes) {
    waiting_.push_back({std::move(event), bytes});
    bytes_ += bytes;
    const Bounds bounds = bounds_now();
    while (waiting_.size() > 1 && (waiting_.size() > bounds.events || bytes_ > bounds.bytes)) {
      drop_oldest();
      ++lost_;
    }
  }

  /// Bounds it by `wide` until settle(), where these are larger: what comes at once when a
  /// subscription begins is not what its bounds are for.
  void widen(const Bounds& wide) { wide_ = wide; }

  /// Ends widen(). What waits stays, and the usual bounds are for what comes beyond it.
  void settle() {
    if (!wide_) return;
    wide_.reset();
    beyond_ = {waiting_.size(), bytes_};
  }

  /// Removes the events of which `is_gone` is true. They do not count as dropped.
  template <typename IsGone>
  void erase_if(const IsGone& is_gone) {
    size_t at = 0;
    const size_t settled = beyond_.events;
    std::erase_if(waiting_, [&](const Waiting& one) {
      const bool is_settled = at++ < settled;
      if (!is_gone(one.event)) return false;
      bytes_ -= one.bytes;
      if (is_settled) narrow(one.bytes);
      return true;
    });
  }

  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  [[nodiscard]] size_t size() const { return waiting_.size(); }
  [[nodiscard]] size_t bytes() const { return bytes_; }
  /// The number of dropped events since the queue was made.
  [[nodiscard]] uint64_t lost() const { return lost_; }

  /// The oldest event. Needs one.
  [[nodiscard]] const Event& next() const { return waiting_.front().event; }

  /// Removes and returns the oldest event. Needs one.
  Event pop() {
    Event event = std::move(waiting_.front().event);
    if (beyond_.events > 0) narrow(waiting_.front().bytes);
    drop_oldest();
    return event;
  }

 private:
  struct Waiting {
    Event event;
    size_t bytes = 0;
  };

  [[nodiscard]] Bounds bounds_now() const {
    if (wide_)
      return {std::max(bounds_.events, wide_->events), std::max(bounds_.bytes, wide_->bytes)};
    return {bounds_.events + beyond_.events, bounds_.bytes + beyond_.bytes};
  }

  /// One of those that waited when it settled is no more. The last one ends it, whatever was
  /// dropped meanwhile.
  void narrow(size_t bytes) {
    --beyond_.events;
    beyond_.bytes = beyond_.events == 0 ? 0 : beyond_.bytes - std::min(beyond_.bytes, bytes);
  }

  void drop_oldest() {
    bytes_ -= waiting_.front().bytes;
    waiting_.pop_front();
  }

  Bounds bounds_;
  std::optional<Bounds> wide_;
  Bounds beyond_{.events = 0, .bytes = 0};  ///< What waited when it settled, and still does.
  std::deque<Waiting> waiting_;
  size_t bytes_ = 0;
  uint64_t lost_ = 0;
};

}  // namespace engram::memory
