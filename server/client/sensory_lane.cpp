// SPDX-License-Identifier: Apache-2.0
#include "server/client/sensory_lane.h"

#include <algorithm>

#include "ltm/core/log.h"
#include "server/wire/polling_threads.h"
#include "server/wire/wire_block.h"

namespace engram::server {

namespace {

constexpr auto kOpenAgainAfter = std::chrono::seconds(1);

}  // namespace

struct SensoryLane::Ring {
  Ring(uint64_t named, SharingClient::KeptBlock mapped, Buffer told, Duration hold)
      : id(named),
        entries(std::move(mapped)),
        control(std::move(told)),
        writer(entries.bytes, *reinterpret_cast<const SensoryControl*>(control.data()), hold) {}

  const uint64_t id;
  const SharingClient::KeptBlock entries;
  const Buffer control;
  Mutex writing;  ///< Entries are written one at a time.
  SensoryRingWriter writer ENGRAM_GUARDED_BY(writing);
};

std::optional<SensoryLane::Target> SensoryLane::find_known(const ltm::Commit& commit,
                                                           bool& is_complete) {
  Target target;
  is_complete = true;
  for (const ltm::EntityUpdate& update : commit.updates) {
    const auto place = places_.find(update.entity);
    if (place == places_.end()) {
      is_complete = false;
      return std::nullopt;
    }
    if (!target.ring) target.ring = place->second.ring;
    if (target.ring != place->second.ring || (target.entities & place->second.bit) != 0)
      return std::nullopt;
    target.entities |= place->second.bit;
  }
  return target;
}

std::optional<SensoryLane::Target> SensoryLane::find(const ltm::Commit& commit) {
  if (commit.updates.empty() || commit.updates.size() > kMaxRingEntities) return std::nullopt;
  bool is_complete = false;
  {
    const MutexLock lock(mutex_);
    auto target = find_known(commit, is_complete);
    if (is_complete || is_opening_ || steady_now() < open_again_) return target;
    is_opening_ = true;
  }
  const Status opened = open(commit);
  const MutexLock lock(mutex_);
  is_opening_ = false;
  if (opened.ok()) return find_known(commit, is_complete);
  // A commit that is not sent by a ring is told by its reply why it is refused.
  log::debug("no sensory ring: {}", opened.to_string());
  open_again_ = steady_now() + kOpenAgainAfter;
  return std::nullopt;
}

Status SensoryLane::open(const ltm::Commit& commit) {
  v1::CommitRequest request;
  for (const ltm::EntityUpdate& update : commit.updates)
    request.add_sensory_entities(update.entity.to_string());
  ENGRAM_ASSIGN_OR_RETURN(const v1::CommitReply reply, ask_(std::move(request)));
  const v1::SensoryRing& told = reply.ring();
  if (!reply.has_ring() || told.places_size() != static_cast<int>(commit.updates.size()))
    return unavailable("the server gave no ring");
  ENGRAM_ASSIGN_OR_RETURN(const auto ring, map(told));
  const MutexLock lock(mutex_);
  for (size_t i = 0; i < commit.updates.size(); ++i) {
    const uint32_t place = told.places(static_cast<int>(i));
    if (place >= kMaxRingEntities) return data_loss("the server gave a place of {}", place);
    places_[commit.updates[i].entity] = {ring, uint64_t{1} << place};
  }
  return {};
}

Result<std::shared_ptr<SensoryLane::Ring>> SensoryLane::map(const v1::SensoryRing& told) {
  {
    const MutexLock lock(mutex_);
    for (const auto& [entity, place] : places_)
      if (place.ring->id == told.id()) return place.ring;
  }
  SharingClient& memory = shared_->memory();
  ENGRAM_ASSIGN_OR_RETURN(auto entries, memory.keep_writable(to_block(told.entries())));
  // The server keeps it as long as this client lives, and is told nothing when it is released.
  ENGRAM_ASSIGN_OR_RETURN(auto control,
                          memory.readable(to_block(told.control()), sizeof(SensoryControl),
                                          [](const BlockRef& /*block*/) {}));
  if (entries.bytes.size() < kMinSensoryRing || told.hold_ns() <= 0)
    return data_loss("the server gave a ring of {} bytes for {} ns", entries.bytes.size(),
                     told.hold_ns());
  v1::CommitRequest mapped;
  mapped.mutable_entry()->set_ring(told.id());
  ENGRAM_RETURN_IF_ERROR(ask_(std::move(mapped)).status());
  return std::make_shared<Ring>(told.id(), std::move(entries), std::move(control),
                                Duration(told.hold_ns()));
}

void SensoryLane::forget(const std::shared_ptr<Ring>& ring) {
  const MutexLock lock(mutex_);
  std::erase_if(places_, [&](const auto& one) { return one.second.ring == ring; });
}

std::optional<Result<SensoryLane::Written>> SensoryLane::write(const ltm::Commit& commit) {
  const auto target = find(commit);
  if (!target) return std::nullopt;
  Ring& ring = *target->ring;
  v1::CommitRequest head;
  describe_in_block(commit, head);
  const size_t head_bytes = head.ByteSizeLong();
  // The server reads no longer one from a ring, and takes it as any other commit.
  if (head_bytes > kMaxHeadBytes) return std::nullopt;
  Written written;
  written.entry.set_ring(ring.id);
  bool is_closed = false;
  {
    // Whoever writes may wait for the server to take what it needs.
    const BlockingScope blocking;
    const MutexLock lock(ring.writing);
    const auto sync = [&]() ENGRAM_REQUIRES(ring.writing) {
      v1::CommitRequest request;
      *request.mutable_entry() = written.entry;
      request.mutable_entry()->set_written(ring.writer.written());
      if (const auto taken = ask_(std::move(request)); !taken.ok())
        log::debug("sensory ring: {}", taken.status().to_string());
    };
    auto room = ring.writer.reserve(head_bytes, head.block_bytes(), steady_now(), sync);
    // The server says what is too large for it.
    if (!room.ok()) return std::nullopt;
    if (Status status = write_data(commit, room->data, ReadBack::kSeldom); !status.ok())
      return status;
    if (!head.SerializeToArray(room->head.data(), static_cast<int>(head_bytes)))
      return invalid_argument("the head of a commit could not be written");
    const Time first = std::ranges::min_element(commit.updates, {}, &ltm::EntityUpdate::time)->time;
    const uint64_t sequence = ring.writer.publish(target->entities, first, steady_now());
    written.entry.set_written(sequence + 1);
    written.is_attended = ring.writer.is_attended(target->entities);
    is_closed = ring.writer.is_closed();
  }
  if (!is_closed) return written;
  forget(target->ring);
  return std::nullopt;
}

}  // namespace engram::server
