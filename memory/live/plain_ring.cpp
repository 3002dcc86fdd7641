// SPDX-License-Identifier: Apache-2.0
#include "memory/live/plain_ring.h"

#include "ltm/core/log.h"
#include "ltm/idf/held_bytes.h"
#include "ltm/working/memory_limits.h"

namespace engram::memory {

size_t PlainRing::bytes_of(const ltm::EntityUpdate& update, const std::vector<Buffer>& encoded) {
  size_t bytes = ltm::kSnapshotOverhead;
  for (const Buffer& came : encoded) bytes += came.size();
  for (const ltm::Instance& instance : update.instances)
    bytes +=
        idf::held_bytes(instance.data) + (encoded.empty() ? idf::element_bytes(instance.data) : 0);
  return bytes;
}

bool PlainRing::hold(const SharedSensoryEntity& entity, ltm::EntityUpdate& update,
                     std::vector<Buffer>& encoded) {
  const size_t bytes = bytes_of(update, encoded);
  const SteadyTime now = steady_now();
  Held gone;
  const MutexLock lock(mutex_);
  ++counts_.committed;
  if (entity->is_attended()) {
    pass_attended(now);
    ++counts_.passed;
    return false;
  }
  drop_old(now, gone);
  while (!held_.empty() && bytes_ + bytes > max_bytes_) {
    if (counts_.crowded_out == 0)
      log::warning(
          "sensory memory '{}': {} bytes are too few to hold {} of what comes; what is "
          "lost before is counted (sensory_crowded_out)",
          segment_.match.to_string(), max_bytes_, to_string(segment_.hold));
    ++counts_.crowded_out;
    drop_oldest(gone);
  }
  bytes_ += bytes;
  held_.push_back({entity, now, bytes, std::move(update), std::move(encoded)});
  return true;
}

void PlainRing::pass() {
  // What is held now passes, however long another thread passes what it does.
  const SteadyTime now = steady_now();
  const MutexLock lock(mutex_);
  pass_attended(now);
}

void PlainRing::pass_attended(SteadyTime now) {
  std::erase_if(held_, [&](HeldUpdate& one) ENGRAM_REQUIRES(mutex_) {
    if (!one.entity->is_attended() || now - one.came > one.entity->hold) return false;
    pass_one(one);
    return true;
  });
}

void PlainRing::pass_chosen(const IsChosen& is_chosen) {
  const SteadyTime now = steady_now();
  const MutexLock lock(mutex_);
  std::erase_if(held_, [&](HeldUpdate& one) ENGRAM_REQUIRES(mutex_) {
    if (now - one.came > one.entity->hold || !is_chosen(one.entity->id, one.update.time))
      return false;
    pass_one(one);
    return true;
  });
}

void PlainRing::pass_one(HeldUpdate& one) {
  const std::string id = one.update.id().to_string();
  std::vector<std::vector<Buffer>> encoded;
  if (!one.encoded.empty()) encoded.push_back(std::move(one.encoded));
  ltm::Commit commit;
  commit.updates.push_back(std::move(one.update));
  const Status passed = pass_(std::move(commit), std::move(encoded));
  if (!passed.ok()) log::debug("sensory memory: '{}': {}", id, passed.message());
  ++(passed.ok() ? counts_.passed : counts_.refused);
  bytes_ -= one.bytes;
}

void PlainRing::note_earliest(EarliestTimes& times) const {
  const SteadyTime now = steady_now();
  const MutexLock lock(mutex_);
  for (const HeldUpdate& one : held_)
    if (now - one.came <= one.entity->hold) times.note(one.entity->id, one.update.time);
}

void PlainRing::drop_oldest(Held& gone) {
  bytes_ -= held_.front().bytes;
  gone.push_back(std::move(held_.front()));
  held_.pop_front();
}

void PlainRing::drop_old(SteadyTime now, Held& gone) {
  while (!held_.empty() && now - held_.front().came > segment_.hold) drop_oldest(gone);
}

bool PlainRing::sweep(SteadyTime now) {
  Held gone;
  const MutexLock lock(mutex_);
  drop_old(now, gone);
  return true;
}

SensoryCounts PlainRing::counts() const {
  const MutexLock lock(mutex_);
  SensoryCounts counts = counts_;
  counts.held = held_.size();
  counts.held_bytes = bytes_;
  return counts;
}

}  // namespace engram::memory
