// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/replayed_past.h"

namespace engram::ltm {

std::shared_ptr<const EntityArrivals> KnownArrivals::find(const MemoryId& entity) const {
  const SharedLock lock(mutex_);
  const auto known = arrivals_.find(entity);
  return known == arrivals_.end() ? nullptr : known->second;
}

void KnownArrivals::put(const MemoryId& entity, std::shared_ptr<const EntityArrivals> arrivals) {
  const ExclusiveLock lock(mutex_);
  arrivals_.insert_or_assign(entity, std::move(arrivals));
}

ReplayedPast::ReplayedPast(std::unique_ptr<StorePast> store, Clock now,
                           std::shared_ptr<KnownArrivals> arrivals)
    : store_(std::move(store)),
      clock_(std::move(now)),
      now_(clock_()),
      arrivals_(std::move(arrivals)) {}

Result<std::unique_ptr<ReplayedPast>> ReplayedPast::open(const std::filesystem::path& store,
                                                         ModelLoader loader, Clock now,
                                                         ReplayedPast* beside) {
  constexpr size_t kMaxDecodedBytes = size_t{64} << 20;
  ENGRAM_ASSIGN_OR_RETURN(auto past, StorePast::open(store, std::move(loader),
                                                     {.max_decoded_bytes = kMaxDecodedBytes}));
  auto arrivals = std::make_shared<KnownArrivals>();
  // What is in journals changes within a generation.
  const auto is_same = [&](StoreReader& other) {
    return other.manifest().generation == past->store().manifest().generation &&
           other.journal_times().empty() && past->store().journal_times().empty();
  };
  if (beside != nullptr && is_same(beside->store())) arrivals = beside->arrivals_;
  return std::make_unique<ReplayedPast>(std::move(past), std::move(now), std::move(arrivals));
}

Result<std::shared_ptr<const EntityArrivals>> ReplayedPast::arrivals(const MemoryId& entity) {
  if (auto known = arrivals_->find(entity)) return known;
  ENGRAM_ASSIGN_OR_RETURN(auto read, EntityArrivals::read(store(), entity));
  arrivals_->put(entity, read);
  return read;
}

std::vector<MemoryId> ReplayedPast::matching(const Query& query) {
  std::vector<MemoryId> known = store_->matching(query);
  std::erase_if(known, [this](const MemoryId& entity) {
    const auto past = of(entity);
    return past.ok() && *past == nullptr;
  });
  return known;
}

Result<std::unique_ptr<EntityPast>> ReplayedPast::of(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(auto past, store_->of(entity));
  if (!past) return past;
  ENGRAM_ASSIGN_OR_RETURN(auto arrivals, this->arrivals(entity));
  return arrived_past(std::move(past), std::move(arrivals), now_);
}

Status ReplayedPast::renew() {
  arrivals_ = std::make_shared<KnownArrivals>();
  return store_->renew();
}

Status ReplayedPast::start_anew() {
  arrivals_ = std::make_shared<KnownArrivals>();
  return store_->start_anew();
}

Status ReplayedPast::follow() {
  const Time now = clock_();
  if (now < now_) ++era_;
  now_ = now;
  return store_->follow();
}

}  // namespace engram::ltm
