// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
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
    while (waiting_.size() > 1 && (waiting_.size() > bounds_.events || bytes_ > bounds_.bytes)) {
      pop();
      ++lost_;
    }
  }

  /// Removes the events of which `is_gone` is true. They do not count as dropped.
  template <typename IsGone>
  void erase_if(const IsGone& is_gone) {
    std::erase_if(waiting_, [&](const Waiting& one) {
      if (!is_gone(one.event)) return false;
      bytes_ -= one.bytes;
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
    bytes_ -= waiting_.front().bytes;
    waiting_.pop_front();
    return event;
  }

 private:
  struct Waiting {
    Event event;
    size_t bytes = 0;
  };

  Bounds bounds_;
  std::deque<Waiting> waiting_;
  size_t bytes_ = 0;
  uint64_t lost_ = 0;
};

}  // namespace engram::memory
