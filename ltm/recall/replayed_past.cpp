// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/replayed_past.h"

namespace engram::ltm {

ReplayedPast::ReplayedPast(std::unique_ptr<StorePast> store, Clock now)
    : store_(std::move(store)), clock_(std::move(now)), now_(clock_()) {}

Result<std::unique_ptr<ReplayedPast>> ReplayedPast::open(const std::filesystem::path& store,
                                                         ModelLoader loader, Clock now) {
  constexpr size_t kMaxDecodedBytes = size_t{64} << 20;
  ENGRAM_ASSIGN_OR_RETURN(auto past, StorePast::open(store, std::move(loader),
                                                     {.max_decoded_bytes = kMaxDecodedBytes}));
  return std::make_unique<ReplayedPast>(std::move(past), std::move(now));
}

Result<std::shared_ptr<const EntityArrivals>> ReplayedPast::arrivals(const MemoryId& entity) {
  if (const auto known = arrivals_.find(entity); known != arrivals_.end()) return known->second;
  ENGRAM_ASSIGN_OR_RETURN(auto read, EntityArrivals::read(store(), entity));
  return arrivals_.emplace(entity, std::move(read)).first->second;
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
  arrivals_.clear();
  return store_->renew();
}

Status ReplayedPast::start_anew() {
  arrivals_.clear();
  return store_->start_anew();
}

Status ReplayedPast::follow() {
  const Time now = clock_();
  if (now < now_) ++era_;
  now_ = now;
  return store_->follow();
}

}  // namespace engram::ltm
