// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "ltm/filter/filter.h"

namespace engram::ltm {

/// Holds what the filters of an entity dropped for a while, because another snapshot may link to
/// it.
///
/// A link names a snapshot of the past, or of the future where entities come at times of their own.
/// Threading: one thread.
/// Source: docs/recording.md, section "What others link to".
class LinkedBuffer {
 public:
  struct Options {
    Duration keeps{};  ///< How long after a snapshot others may link to it, by their times.
    /// Beyond it the oldest go. Unit: plain bytes, and an overhead for each snapshot.
    uint64_t max_held_bytes = uint64_t{64} << 20;
  };

  /// What a filter dropped.
  struct Dropped {
    Candidate candidate;
    size_t stage = 0;         ///< The filter in its chain.
    std::string_view reason;  ///< Lives as long as the program.
  };

  explicit LinkedBuffer(const Options& options) : options_(options) {}

  /// Takes what a filter dropped. Returns it if it is wanted already.
  [[nodiscard]] std::optional<Dropped> add(Dropped dropped);

  /// Something links to the snapshot of this time. Returns it if it was dropped; otherwise it is
  /// wanted once it is.
  [[nodiscard]] std::optional<Dropped> want(Time time);

  /// Gives up what is too old or too much, now that the entity is at `newest`.
  [[nodiscard]] std::vector<Dropped> give_up(Time newest);
  [[nodiscard]] std::vector<Dropped> give_up_all();
  /// Gives up these times alone.
  [[nodiscard]] std::vector<Dropped> give_up(const TimeSet& times);

  void add_held_times(TimeSet& times) const;
  [[nodiscard]] HeldSnapshots held() const { return {held_.size(), held_bytes_}; }
  [[nodiscard]] HeldSnapshots held_of(size_t stage) const;

 private:
  using Held = std::map<Time, Dropped>;

  Dropped take(Held::iterator at);

  Options options_;
  Held held_;
  uint64_t held_bytes_ = 0;
  std::set<Time> wanted_;  ///< Times that something links to, which were not dropped so far.
};

}  // namespace engram::ltm
