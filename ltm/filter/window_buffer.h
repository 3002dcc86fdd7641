// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string_view>

#include "ltm/filter/filter.h"

namespace engram::ltm {

/// Holds the newest candidates until an event comes, whose window keeps them, or they are too old
/// for any event.
///
/// Windows that follow each other become one, and nothing between an event and a later window that
/// was already open is lost. Order is kept: a candidate waits for those before it.
/// Threading: one thread.
class WindowBuffer {
 public:
  struct Options {
    Duration before{};              ///< Time that is kept before an event.
    std::optional<Duration> after;  ///< Time that is kept after it. Empty: everything that follows.
    uint64_t max_held_bytes = 0;    ///< Beyond it the oldest candidates are dropped.
    std::string_view reason;        ///< Drop reason of candidates for which no event came.
  };

  /// Bytes that a held candidate counts beyond its plain bytes, so that the number of tiny ones is
  /// bounded too.
  static constexpr uint64_t kHeldOverheadBytes = 512;

  explicit WindowBuffer(const Options& options) : options_(options) {}

  /// Adds a candidate. With `is_wanted` it is kept even without an event.
  void add(Candidate candidate, bool is_wanted);

  /// Opens the window of an event at `time`.
  void mark(Time time);

  /// Decides on all candidates that can be decided on.
  void settle(FilterDecisions& decisions);

  void flush(FilterDecisions& decisions);

  void add_held_times(TimeSet& times) const;
  /// See Filter::forget.
  void forget(const TimeSet& times, FilterDecisions& decisions);

  [[nodiscard]] bool is_open_at(Time time) const;
  [[nodiscard]] HeldSnapshots held() const { return {queue_.size(), held_bytes_}; }

 private:
  struct Held {
    Candidate candidate;
    bool is_wanted = false;
  };
  struct Window {
    Time first{};
    Time last{};
  };

  void pop(std::string_view reason, FilterDecisions& decisions);

  Options options_;
  std::deque<Held> queue_;
  uint64_t held_bytes_ = 0;
  std::optional<Window> window_;
  Time newest_ = Time::min();
};

}  // namespace engram::ltm
