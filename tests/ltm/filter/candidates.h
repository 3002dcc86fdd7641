// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "ltm/filter/filter.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/print_values.h"

namespace engram::ltm {

inline Time at_second(double seconds) {
  return Time(*duration_from_seconds(1.6e9) + *duration_from_seconds(seconds));
}

inline MemoryId filtered_entity(const std::string& name = "d") {
  return *MemoryId::from_names({"a", "b", "c", name});
}

inline Candidate candidate(double seconds, idf::Data value = idf::None{},
                           const std::string& name = "d") {
  Candidate made{{filtered_entity(name), at_second(seconds), {{std::move(value), {}}}}};
  made.raw_bytes = made.snapshot.raw_bytes();
  return made;
}

/// What a filter keeps and drops of what it is offered.
class FilterRun {
 public:
  explicit FilterRun(Filter& filter) : filter_(filter) {}

  /// True where exactly this candidate left the filter.
  bool keeps(Candidate offered) {
    const Time time = offered.snapshot.time;
    const size_t before = decisions_.kept.size();
    filter_.offer(std::move(offered), decisions_);
    return decisions_.kept.size() == before + 1 && decisions_.kept.back().snapshot.time == time;
  }
  void offer(Candidate offered) { filter_.offer(std::move(offered), decisions_); }
  void notice(const Candidate& other) { filter_.notice(other.snapshot, other.type, decisions_); }
  void flush() { filter_.flush(decisions_); }

  /// Seconds of what was kept, in the order in which it came out.
  [[nodiscard]] std::vector<double> kept() const {
    std::vector<double> seconds;
    for (const Candidate& each : decisions_.kept)
      seconds.push_back(to_seconds(each.snapshot.time - at_second(0)));
    return seconds;
  }
  [[nodiscard]] const FilterDecisions& decisions() const { return decisions_; }
  [[nodiscard]] size_t dropped(std::string_view reason) const {
    size_t count = 0;
    for (const auto& drop : decisions_.dropped) count += drop.reason == reason ? 1 : 0;
    return count;
  }

 private:
  Filter& filter_;
  FilterDecisions decisions_;
};

}  // namespace engram::ltm
