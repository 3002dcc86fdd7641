// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/shared_ring.h"

#include <algorithm>
#include <bit>
#include <new>

#include "ltm/core/log.h"
#include "server/sharing/ring_places.h"

namespace engram::server {

Result<std::shared_ptr<SharedRing>> SharedRing::create(RpcContext& context, const Identity& who,
                                                       ClientId client, uint64_t id,
                                                       const memory::SensorySegment& segment) {
  const size_t bytes = context.service.sensory()->options().ring_bytes;
  ENGRAM_ASSIGN_OR_RETURN(auto memory,
                          context.sharing->lease_ring(client, bytes, sizeof(SensoryControl)));
  return std::shared_ptr<SharedRing>(
      new SharedRing(context, who, client, id, segment, std::move(memory)));
}

SharedRing::SharedRing(RpcContext& context, Identity who, ClientId client, uint64_t id,
                       const memory::SensorySegment& segment, SharedSessions::RingMemory memory)
    : context_(context),
      who_(std::move(who)),
      client_(client),
      id_(id),
      segment_(segment),
      memory_(std::move(memory)),
      control_(new (memory_.control_written.data()) SensoryControl),
      outcomes_(fmt::format("sensory ring of '{}'", segment_.match.to_string())) {}

SharedRing::~SharedRing() = default;

Result<std::vector<uint32_t>> SharedRing::places_of(std::span<const ltm::MemoryId> entities) {
  std::vector<memory::SharedSensoryEntity> known;
  for (const ltm::MemoryId& id : entities) {
    ENGRAM_ASSIGN_OR_RETURN(auto one, context_.service.sensory()->entity(id));
    known.push_back(std::move(one));
  }
  std::vector<uint32_t> places;
  {
    const MutexLock lock(placing_);
    const size_t before = entities_.size();
    for (auto& one : known) {
      const auto found = std::ranges::find(entities_, one);
      places.push_back(static_cast<uint32_t>(found - entities_.begin()));
      if (found == entities_.end()) entities_.push_back(std::move(one));
    }
    if (entities_.size() > kMaxRingEntities) {
      // All of them or none: a place that nobody was told of would never be used.
      entities_.resize(before);
      return resource_exhausted("sensory ring of '{}': has {} entities, needs fewer",
                                segment_.match.to_string(), before);
    }
  }
  // Whoever opened attention to them since is seen here, or sees them in the list.
  attention_changed();
  return places;
}

Result<bool> SharedRing::begin() {
  const MutexLock lock(passing_);
  if (reader_ || is_closed()) return false;
  ENGRAM_ASSIGN_OR_RETURN(Buffer entries, context_.sharing->begin_ring(client_, memory_));
  entries_ = std::move(entries);
  reader_.emplace(entries_->bytes());
  return true;
}

void SharedRing::attention_changed() {
  const MutexLock lock(placing_);
  uint64_t attended = 0;
  for (size_t i = 0; i < entities_.size(); ++i)
    if (entities_[i]->is_attended()) attended |= bit_of_place(i);
  const uint64_t before = control_->attended;
  if (attended == before) return;
  if ((attended & ~before) != 0) {
    // From now on nothing is overwritten that did not pass. This comes first: what was taken for
    // others was not taken for who opens attention now.
    ++openings_;
    control_->taken = 0;
    // What came until then passes if it was still held then, however late the server looks.
    const int64_t oldest = oldest_came();
    for (const size_t place : RingPlaces(attended & ~before)) {
      oldest_passed_[place] = oldest;
    }
  }
  control_->attended = attended;
}

int64_t SharedRing::oldest_came() const {
  return Duration(steady_now().time_since_epoch() - segment_.hold).count();
}

void SharedRing::close(const std::string& why) {
  log::warning("sensory ring of '{}': its client broke it: {}", segment_.match.to_string(), why);
  control_->is_closed = 1;
  counts_.committed = reader_->snapshots();
  counts_.crowded_out = reader_->crowded_out();
  reader_.reset();
  entries_.reset();
}

void SharedRing::end() {
  const MutexLock lock(passing_);
  // What it wrote and could not tell any more.
  pass_attended(false);
  ended_ = steady_now();
  if (!reader_) context_.sharing->abandon_ring(client_, memory_);
}

bool SharedRing::sweep(SteadyTime now) {
  const MutexLock lock(passing_);
  if (reader_ && !is_crowding_told_ && reader_->crowded_out() > 0) {
    is_crowding_told_ = true;
    log::warning(
        "sensory ring of '{}': {} bytes are too few to hold {} of what comes; what is lost before "
        "is counted (sensory_crowded_out)",
        segment_.match.to_string(), entries_->size(), engram::to_string(segment_.hold));
  }
  return reader_ && (!ended_ || now - *ended_ <= segment_.hold);
}

void SharedRing::note_earliest(memory::EarliestTimes& times) const {
  const MutexLock lock(passing_);
  if (!reader_) return;
  OfPlaces earliest;
  earliest.fill(INT64_MAX);
  const SensoryRingReader::Range range = reader_->entries();
  const int64_t oldest = oldest_came();
  for (uint64_t sequence = range.first; sequence < range.end; ++sequence) {
    const auto entry = reader_->find(sequence);
    if (!entry || entry->came_ns < oldest) continue;
    for (const size_t place : RingPlaces(not_passed(entry->entities, sequence))) {
      earliest[place] = std::min(earliest[place], entry->first_time_ns);
    }
  }
  const MutexLock placing(placing_);
  for (size_t place = 0; place < entities_.size(); ++place)
    if (earliest[place] != INT64_MAX)
      times.note(entities_[place]->id, time_from_ns(earliest[place]));
}

memory::SensoryCounts SharedRing::counts() const {
  const MutexLock lock(passing_);
  memory::SensoryCounts counts = counts_;
  if (!reader_) return counts;
  // Ahead of the entries: those that are written meanwhile are held, and not lost.
  counts.committed = reader_->snapshots();
  const SensoryRingReader::Range range = reader_->entries();
  const int64_t oldest = oldest_came();
  for (uint64_t sequence = range.first; sequence < range.end; ++sequence) {
    const auto entry = reader_->find(sequence);
    if (!entry || entry->came_ns < oldest) continue;
    const uint64_t left = not_passed(entry->entities, sequence);
    if (left == 0) continue;
    counts.held += static_cast<uint64_t>(std::popcount(left));
    counts.held_bytes += entry->head_bytes + entry->data_bytes;
  }
  counts.crowded_out = reader_->crowded_out();
  return counts;
}

}  // namespace engram::server
