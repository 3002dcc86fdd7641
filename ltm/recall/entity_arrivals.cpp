// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/entity_arrivals.h"

#include <algorithm>
#include <numeric>

#include "ltm/recall/past_context.h"
#include "ltm/recall/seen_past.h"

namespace engram::ltm {

namespace {

/// When a snapshot counts as arrived.
Time came_at(Time time, Time arrived) {
  const auto low = static_cast<uint64_t>(to_ns(std::min(time, arrived)));
  const auto high = static_cast<uint64_t>(to_ns(std::max(time, arrived)));
  const auto max = static_cast<uint64_t>(EntityArrivals::kMaxDelay.count());
  return high - low > max ? time : arrived;
}

/// A past in a list of some of its moments.
class ArrivedPast final : public EntityPast {
 public:
  ArrivedPast(std::unique_ptr<EntityPast> past, std::shared_ptr<const EntityArrivals> arrivals,
              Time now)
      : past_(std::move(past)),
        arrivals_(std::move(arrivals)),
        times_(arrivals_->arrived_until(now, own_)) {}

  [[nodiscard]] bool empty() const { return times_.empty(); }

  Result<std::optional<Time>> first() override { return nth(0); }
  Result<std::optional<Time>> last() override {
    return times_.empty() ? std::nullopt : std::optional(times_.back());
  }
  Result<std::optional<Time>> at_or_after(Time time) override {
    const auto found = std::ranges::lower_bound(times_, time);
    return found == times_.end() ? std::nullopt : std::optional(*found);
  }
  Result<std::optional<Time>> at_or_before(Time time) override {
    const auto behind = std::ranges::upper_bound(times_, time);
    return behind == times_.begin() ? std::nullopt : std::optional(*std::prev(behind));
  }
  Result<std::optional<Time>> nth(uint64_t index) override {
    return index < times_.size() ? std::optional(times_[index]) : std::nullopt;
  }
  Result<uint64_t> count() override { return uint64_t{times_.size()}; }

  Result<SharedContext> context(const std::optional<idf::Type>& type) override {
    ENGRAM_ASSIGN_OR_RETURN(const SharedContext all, past_->context(type));
    return context_at(all, times_);
  }

  Result<RecalledSnapshot> read(Time moment, Prefer prefer) override {
    check(moment);
    return past_->read(moment, prefer);
  }
  Result<RecalledSnapshot> name(Time moment, Prefer prefer) override {
    check(moment);
    return past_->name(moment, prefer);
  }

 private:
  void check(Time moment) const {
    ENGRAM_CHECK(std::ranges::binary_search(times_, moment), "{} has not arrived yet",
                 to_string(moment));
  }

  const std::unique_ptr<EntityPast> past_;
  const std::shared_ptr<const EntityArrivals> arrivals_;
  std::vector<Time> own_;
  const std::span<const Time> times_;
};

}  // namespace

Result<std::shared_ptr<const EntityArrivals>> EntityArrivals::read(StoreReader& store,
                                                                   const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const bool is_in_time, store.arrived_in_time(entity));
  if (is_in_time) return std::make_shared<const EntityArrivals>();
  ENGRAM_ASSIGN_OR_RETURN(const auto snapshots, store.arrivals(entity));
  std::vector<Time> times, arrived;
  times.reserve(snapshots.size());
  arrived.reserve(snapshots.size());
  for (const ArrivedSnapshot& one : snapshots) {
    times.push_back(one.time);
    arrived.push_back(came_at(one.time, one.arrived));
  }
  if (times == arrived) return std::make_shared<const EntityArrivals>();
  return std::make_shared<const EntityArrivals>(std::move(times), std::move(arrived));
}

EntityArrivals::EntityArrivals(std::vector<Time> times, std::vector<Time> arrived)
    : is_in_time_(false), times_(std::move(times)), arrived_(std::move(arrived)) {
  ENGRAM_CHECK(times_.size() == arrived_.size(), "{} times and {} arrivals", times_.size(),
               arrived_.size());
  if (std::ranges::is_sorted(arrived_)) return;
  in_order_.resize(times_.size());
  std::iota(in_order_.begin(), in_order_.end(), 0);
  // Times increase, so a stable sort orders equal arrivals by them.
  std::ranges::stable_sort(in_order_, {}, [this](uint32_t place) { return arrived_[place]; });
}

std::span<const Time> EntityArrivals::arrived_until(Time now, std::vector<Time>& own) const {
  ENGRAM_CHECK(!is_in_time_, "the timeline tells");
  if (in_order_.empty()) {
    const auto behind = std::ranges::upper_bound(arrived_, now);
    return std::span(times_).first(static_cast<size_t>(behind - arrived_.begin()));
  }
  own.clear();
  for (size_t i = 0; i < times_.size(); ++i)
    if (arrived_[i] <= now) own.push_back(times_[i]);
  return own;
}

Arrival EntityArrivals::nth(size_t place) const {
  const size_t index = in_order_.empty() ? place : in_order_[place];
  return {arrived_[index], times_[index]};
}

std::optional<Arrival> EntityArrivals::next(const Arrival& after) const {
  ENGRAM_CHECK(!is_in_time_, "the timeline tells");
  size_t low = 0, high = times_.size();
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (nth(middle) <= after)
      low = middle + 1;
    else
      high = middle;
  }
  return low == times_.size() ? std::nullopt : std::optional(nth(low));
}

Result<std::unique_ptr<EntityPast>> arrived_past(std::unique_ptr<EntityPast> past,
                                                 std::shared_ptr<const EntityArrivals> arrivals,
                                                 Time now) {
  if (!past) return past;
  if (arrivals->is_in_time()) {
    TimeWindows until;
    until.add({.last = now});
    return seen_past(std::move(past), until);
  }
  auto arrived = std::make_unique<ArrivedPast>(std::move(past), std::move(arrivals), now);
  if (arrived->empty()) return std::unique_ptr<EntityPast>();
  return std::unique_ptr<EntityPast>(std::move(arrived));
}

}  // namespace engram::ltm
