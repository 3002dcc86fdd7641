// SPDX-License-Identifier: Apache-2.0
#include "server/client/sensory_lane.h"

#include <algorithm>
#include <map>

#include "ltm/core/check.h"
#include "ltm/core/log.h"
#include "ltm/idf/binary.h"
#include "server/wire/polling_threads.h"
#include "server/wire/wire_block.h"

namespace engram::server {

namespace {

constexpr auto kOpenAgainAfter = std::chrono::seconds(1);
/// What is lent for what each snapshot says besides its data.
constexpr size_t kLentHeadBytes = 1024;

constexpr size_t aligned_in_room(size_t bytes) {
  return (bytes + 7) / 8 * 8;
}

/// The bytes of the one array of a snapshot; none if it has something else.
Buffer bytes_of_array(const ltm::EntityUpdate& update) {
  if (update.instances.size() != 1) return {};
  const auto* array = update.instances[0].data.get_if<idf::NdArray>();
  return array == nullptr ? Buffer() : array->buffer();
}

/// Whether the arrays of a commit, and nothing else, lie where write_data() writes them.
bool lies_in(const ltm::Commit& commit, std::span<const std::byte> room) {
  size_t at = 0;
  for (const ltm::EntityUpdate& update : commit.updates) {
    const Buffer bytes = bytes_of_array(update);
    if (bytes.empty()) return false;
    const size_t size = idf::encoded_size(update.instances[0].data);
    if (size > room.size() - at || bytes.data() != room.data() + at + size - bytes.size())
      return false;
    at += std::min(aligned_in_room(size), room.size() - at);
  }
  return at == room.size();
}

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
  struct LentRoom {
    SensoryRingWriter::Room room;
    const Lent* lent = nullptr;  ///< The owner of what is written there.
  };
  /// By where its data begin.
  std::map<const std::byte*, LentRoom> lent ENGRAM_GUARDED_BY(writing);

  /// The room that was lent for this commit, if its arrays lie there.
  std::optional<SensoryRingWriter::Room> take_lent(const ltm::Commit& commit, size_t head_bytes)
      ENGRAM_REQUIRES(writing) {
    if (lent.empty() || commit.updates.empty()) return std::nullopt;
    const Buffer first = bytes_of_array(commit.updates[0]);
    auto found = lent.upper_bound(first.data());
    if (first.empty() || found == lent.begin()) return std::nullopt;
    --found;
    const SensoryRingWriter::Room room = found->second.room;
    // An array of an earlier loan may view the same bytes.
    if (first.owner().get() != found->second.lent || head_bytes > room.head.size() ||
        !lies_in(commit, room.data))
      return std::nullopt;
    lent.erase(found);
    return room;
  }
};

/// Owns what is lent: gives it back if it is not committed.
struct SensoryLane::Lent {
  Lent(std::shared_ptr<Ring> of, const std::byte* begins_at)
      : ring(std::move(of)), begin(begins_at) {}
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;
  ~Lent() {
    const BlockingScope blocking;
    const MutexLock lock(ring->writing);
    const auto found = ring->lent.find(begin);
    if (found == ring->lent.end() || found->second.lent != this) return;
    ring->writer.give_back(found->second.room);
    ring->lent.erase(found);
  }

  const std::shared_ptr<Ring> ring;  ///< Keeps its memory mapped.
  const std::byte* const begin;
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

void SensoryLane::sync(uint64_t ring, uint64_t written) const {
  v1::CommitRequest request;
  request.mutable_entry()->set_ring(ring);
  request.mutable_entry()->set_written(written);
  if (const auto taken = ask_(std::move(request)); !taken.ok())
    log::debug("sensory ring: {}", taken.status().to_string());
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
      this->sync(ring.id, ring.writer.written());
    };
    auto room = ring.take_lent(commit, head_bytes);
    if (room) {
      ring.writer.take_back(*room, head_bytes, steady_now(), sync);
      room->head = room->head.first(head_bytes);
    } else {
      auto reserved = ring.writer.reserve(head_bytes, head.block_bytes(), steady_now(), sync);
      // The server says what is too large for it.
      if (!reserved.ok()) return std::nullopt;
      room = *reserved;
    }
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

std::optional<Loan> SensoryLane::lend(std::span<const ArrayToLend> arrays,
                                      const ltm::Commit& named) {
  const auto target = find(named);
  if (!target) return std::nullopt;
  Ring& ring = *target->ring;
  // Where each array begins follows from its type and shape; a view of any bytes tells.
  std::vector<std::pair<size_t, size_t>> spans;  // The first byte and the number of them.
  size_t data_bytes = 0;
  for (const ArrayToLend& one : arrays) {
    const size_t bytes = idf::size_bytes(one.type, one.shape).value_or(SIZE_MAX);
    if (bytes == 0 || bytes > ring.entries.bytes.size()) return std::nullopt;
    const auto array = idf::NdArray::create(
        one.type, one.shape, Buffer(ring.entries.owner, ring.entries.bytes.first(bytes)));
    if (!array.ok()) return std::nullopt;
    const size_t size = idf::encoded_size(*array);
    spans.emplace_back(data_bytes + size - bytes, bytes);
    data_bytes += aligned_in_room(size);
  }
  const BlockingScope blocking;
  const MutexLock lock(ring.writing);
  const auto sync = [&]() ENGRAM_REQUIRES(ring.writing) {
    this->sync(ring.id, ring.writer.written());
  };
  const auto room =
      ring.writer.lend(kLentHeadBytes * arrays.size(), data_bytes, steady_now(), sync);
  if (!room.ok()) return std::nullopt;
  const auto lent = std::make_shared<const Lent>(target->ring, room->data.data());
  ring.lent[room->data.data()] = {*room, lent.get()};
  std::vector<Loan::Place> places;
  for (size_t i = 0; i < arrays.size(); ++i) {
    const std::span<std::byte> bytes = room->data.subspan(spans[i].first, spans[i].second);
    auto array = idf::NdArray::create(arrays[i].type, arrays[i].shape, Buffer(lent, bytes));
    ENGRAM_CHECK(array.ok(), "{}", array.status().message());
    places.push_back({bytes, *std::move(array)});
  }
  return Loan(std::move(places), true);
}

}  // namespace engram::server
