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

/// What had arrived of a past.
class ArrivedPast final : public EntityPast {
 public:
  ArrivedPast(std::unique_ptr<EntityPast> past, std::shared_ptr<const EntityArrivals> arrivals,
              Time now)
      : past_(std::move(past)),
        arrivals_(std::move(arrivals)),
        arrived_(arrivals_->arrived_until(now)) {}

  [[nodiscard]] bool empty() const { return arrived_ == 0; }

  Result<std::optional<Time>> first() override { return time_at(0); }
  Result<std::optional<Time>> last() override {
    return arrived_ == 0 ? std::nullopt : time_at(arrived_ - 1);
  }
  Result<std::optional<Time>> at_or_after(Time time) override {
    return time_at(arrivals_->before(time, arrived_));
  }
  Result<std::optional<Time>> at_or_before(Time time) override {
    if (time == Time::max()) return last();
    const size_t until = arrivals_->before(time + Duration(1), arrived_);
    return until == 0 ? std::nullopt : time_at(until - 1);
  }
  Result<std::optional<Time>> nth(uint64_t index) override { return time_at(index); }
  Result<uint64_t> count() override { return uint64_t{arrived_}; }

  Result<SharedContext> context(const std::optional<idf::Type>& type) override {
    ENGRAM_ASSIGN_OR_RETURN(const SharedContext all, past_->context(type));
    return context_at(all, arrivals_->times(arrived_));
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
  [[nodiscard]] std::optional<Time> time_at(uint64_t index) const {
    if (index >= arrived_) return std::nullopt;
    return arrivals_->nth_time(index, arrived_);
  }
  void check(Time moment) const {
    ENGRAM_CHECK(time_at(arrivals_->before(moment, arrived_)) == moment, "{} has not arrived yet",
                 to_string(moment));
  }

  const std::unique_ptr<EntityPast> past_;
  const std::shared_ptr<const EntityArrivals> arrivals_;
  const size_t arrived_;  ///< So many, in the order of arrivals.
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
  by_time_ = PrefixOrder(in_order_);
}

size_t EntityArrivals::arrived_until(Time now) const {
  ENGRAM_CHECK(!is_in_time_, "the timeline tells");
  return behind({now, Time::max()});
}

// Indices of `times_` are in the order of times, so theirs is that of times.
size_t EntityArrivals::before(Time time, size_t arrived) const {
  const auto found = std::ranges::lower_bound(times_, time);
  const auto bound = static_cast<size_t>(found - times_.begin());
  return in_order_.empty() ? std::min(bound, arrived) : by_time_.below(arrived, bound);
}

Time EntityArrivals::nth_time(size_t index, size_t arrived) const {
  ENGRAM_CHECK(index < arrived, "found snapshot {} of {}", index, arrived);
  return times_[in_order_.empty() ? index : by_time_.nth(arrived, index)];
}

std::vector<Time> EntityArrivals::times(size_t arrived) const {
  if (in_order_.empty()) return {times_.begin(), times_.begin() + static_cast<ptrdiff_t>(arrived)};
  if (arrived == times_.size()) return times_;
  if (arrived == 0) return {};
  const Arrival last = nth(arrived - 1);
  std::vector<Time> times;
  times.reserve(arrived);
  for (size_t i = 0; i < times_.size(); ++i)
    if (Arrival{arrived_[i], times_[i]} <= last) times.push_back(times_[i]);
  return times;
}

Arrival EntityArrivals::nth(size_t place) const {
  const size_t index = in_order_.empty() ? place : in_order_[place];
  return {arrived_[index], times_[index]};
}

size_t EntityArrivals::behind(const Arrival& after) const {
  size_t low = 0, high = times_.size();
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (nth(middle) <= after)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

std::optional<Arrival> EntityArrivals::next(const Arrival& after) const {
  ENGRAM_CHECK(!is_in_time_, "the timeline tells");
  const size_t place = behind(after);
  return place == times_.size() ? std::nullopt : std::optional(nth(place));
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
