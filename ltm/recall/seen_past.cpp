// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/seen_past.h"

#include <algorithm>

#include "ltm/recall/past_context.h"

namespace engram::ltm {

namespace {

using Window = TimeWindows::Window;

class SeenPast final : public EntityPast {
 public:
  SeenPast(std::unique_ptr<EntityPast> past, TimeWindows times)
      : past_(std::move(past)), times_(std::move(times)) {}

  Result<std::optional<Time>> first() override { return at_or_after(time_from_ns(INT64_MIN)); }
  Result<std::optional<Time>> last() override { return at_or_before(time_from_ns(INT64_MAX)); }

  Result<std::optional<Time>> at_or_after(Time time) override {
    for (const Window& window : times_.windows()) {
      if (window.last < time) continue;
      ENGRAM_ASSIGN_OR_RETURN(const auto found, past_->at_or_after(std::max(time, window.first)));
      if (!found || *found <= window.last) return found;
    }
    return std::optional<Time>();
  }

  Result<std::optional<Time>> at_or_before(Time time) override {
    const auto windows = times_.windows();
    for (auto window = windows.rbegin(); window != windows.rend(); ++window) {
      if (window->first > time) continue;
      ENGRAM_ASSIGN_OR_RETURN(const auto found, past_->at_or_before(std::min(time, window->last)));
      if (!found || *found >= window->first) return found;
    }
    return std::optional<Time>();
  }

  Result<std::optional<Time>> nth(uint64_t index) override {
    for (const Window& window : times_.windows()) {
      ENGRAM_ASSIGN_OR_RETURN(const Indices seen, indices_of(window));
      if (index < seen.end - seen.begin) return past_->nth(seen.begin + index);
      index -= seen.end - seen.begin;
    }
    return std::optional<Time>();
  }

  Result<uint64_t> count() override {
    uint64_t count = 0;
    for (const Window& window : times_.windows()) {
      ENGRAM_ASSIGN_OR_RETURN(const Indices seen, indices_of(window));
      count += seen.end - seen.begin;
    }
    return count;
  }

  Result<RecalledSnapshot> read(Time moment, Prefer prefer) override {
    ENGRAM_CHECK(times_.contains(moment), "{} is no moment that may be seen", to_string(moment));
    return past_->read(moment, prefer);
  }

  Result<RecalledSnapshot> name(Time moment, Prefer prefer) override {
    ENGRAM_CHECK(times_.contains(moment), "{} is no moment that may be seen", to_string(moment));
    return past_->name(moment, prefer);
  }

  Result<SharedContext> context(const std::optional<idf::Type>& type) override {
    ENGRAM_ASSIGN_OR_RETURN(const SharedContext all, past_->context(type));
    return context_at(all, times_);
  }

 private:
  struct Indices {
    uint64_t begin = 0, end = 0;
  };

  /// The snapshots of a window, by their indices among all.
  Result<Indices> indices_of(const Window& window) {
    Indices seen;
    ENGRAM_ASSIGN_OR_RETURN(seen.begin, count_until(window.first, false));
    ENGRAM_ASSIGN_OR_RETURN(seen.end, count_until(window.last, true));
    return seen;
  }

  /// How many of all snapshots are before `time`, or at it if it `counts`.
  Result<uint64_t> count_until(Time time, bool counts) {
    uint64_t low = 0;
    ENGRAM_ASSIGN_OR_RETURN(uint64_t high, past_->count());
    while (low < high) {
      const uint64_t middle = low + (high - low) / 2;
      ENGRAM_ASSIGN_OR_RETURN(const auto moment, past_->nth(middle));
      if (moment && (*moment < time || (counts && *moment == time)))
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  }

  const std::unique_ptr<EntityPast> past_;
  const TimeWindows times_;
};

}  // namespace

Result<std::unique_ptr<EntityPast>> seen_past(std::unique_ptr<EntityPast> past,
                                              const TimeWindows& times) {
  if (!past || times.is_all()) return past;
  auto seen = std::make_unique<SeenPast>(std::move(past), times);
  ENGRAM_ASSIGN_OR_RETURN(const auto first, seen->first());
  if (!first) return std::unique_ptr<EntityPast>();
  return std::unique_ptr<EntityPast>(std::move(seen));
}

}  // namespace engram::ltm
