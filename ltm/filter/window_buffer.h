// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string_view>

#include "ltm/filter/filter.h"

namespace engram::ltm {

/// Holds the newest candidates back until an event says that the time around it is kept, or they
/// are too old for any.
///
/// Windows that follow each other become one; nothing between an event and a later window that was
/// already open is lost. Order is kept: a candidate waits for those before it.
/// Threading: one thread.
class WindowBuffer {
 public:
  struct Options {
    Duration before{};              ///< Kept before an event.
    std::optional<Duration> after;  ///< Kept after it. Nothing: all that follows.
    uint64_t max_held_bytes = 0;    ///< The oldest go where more are held.
    std::string_view reason;        ///< Of what no event came for.
  };

  /// What a held candidate counts beyond its plain bytes, so that tiny ones are bounded too.
  static constexpr uint64_t kHeldOverheadBytes = 512;

  explicit WindowBuffer(const Options& options) : options_(options) {}

  /// Takes a candidate; `is_wanted` keeps it whatever comes.
  void add(Candidate candidate, bool is_wanted);

  /// Opens the window of an event at `time`.
  void mark(Time time);

  /// Decides on all that can be decided.
  void settle(FilterDecisions& decisions);

  void flush(FilterDecisions& decisions);

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
