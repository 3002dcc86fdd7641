// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/shared_ring.h"

#include <algorithm>
#include <bit>
#include <new>

#include "ltm/core/log.h"
#include "server/rpc/memory_rpc.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

namespace {

/// The max size of what an entry says besides its data.
constexpr uint64_t kMaxHeadBytes = uint64_t{1} << 20;

/// Smaller data are told by plain bytes, for which a block would be waste.
constexpr size_t kMinBlockBytes = size_t{16} << 10;

/// Why so many of the newest refused entries are remembered: their client asks for the last one.
constexpr size_t kMaxRefusedEntries = 64;

constexpr uint64_t aligned_in_block(uint64_t bytes) {
  return (bytes + 7) / 8 * 8;
}

constexpr uint64_t bit_of(size_t place) {
  return uint64_t{1} << place;
}

}  // namespace

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
      control_(new (memory_.control_written.data()) SensoryControl) {}

SharedRing::~SharedRing() = default;

Result<uint32_t> SharedRing::place_of(const ltm::MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(auto known, context_.service.sensory()->entity(entity));
  uint32_t place = 0;
  {
    const MutexLock lock(placing_);
    const auto found = std::ranges::find(entities_, known);
    place = static_cast<uint32_t>(found - entities_.begin());
    if (found != entities_.end()) return place;
    if (entities_.size() >= kMaxRingEntities)
      return resource_exhausted("sensory ring of '{}': has {} entities, needs fewer",
                                segment_.match.to_string(), entities_.size());
    entities_.push_back(std::move(known));
  }
  // Whoever opened attention to it since is seen here, or sees it in the list.
  attention_changed();
  return place;
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
    if (entities_[i]->is_attended()) attended |= bit_of(i);
  const uint64_t before = control_->attended;
  if (attended == before) return;
  if ((attended & ~before) != 0) {
    // From now on nothing is overwritten that did not pass. This comes first: what was taken for
    // others was not taken for who opens attention now.
    ++openings_;
    control_->taken = 0;
  }
  control_->attended = attended;
}

/// When what can still pass came, at the earliest. Unit: ns of the clock that is never set.
int64_t SharedRing::oldest_came() const {
  return Duration(steady_now().time_since_epoch() - segment_.hold).count();
}

void SharedRing::pass() {
  const MutexLock lock(passing_);
  pass_attended();
}

Status SharedRing::pass_until(uint64_t written) {
  const MutexLock lock(passing_);
  if (!reader_) return failed_precondition("sensory ring {}: has not begun, or is closed", id_);
  pass_attended();
  if (!reader_) return failed_precondition("sensory ring {}: was closed", id_);
  const auto refused = refused_.find(written - 1);
  return refused == refused_.end() ? Status() : refused->second;
}

uint64_t SharedRing::not_passed(uint64_t entities, uint64_t sequence) const {
  uint64_t left = 0;
  for (uint64_t rest = entities; rest != 0; rest &= rest - 1) {
    const auto place = static_cast<size_t>(std::countr_zero(rest));
    if (passed_until_[place] <= sequence) left |= bit_of(place);
  }
  return left;
}

void SharedRing::pass_attended() {
  if (!reader_) return;
  uint64_t attended = 0;
  uint64_t openings = 0;
  {
    const MutexLock lock(placing_);
    attended = control_->attended;
    openings = openings_;
  }
  if (attended == 0) return;
  // After the look at who attends: the client looks after it wrote, so one of both sees the other.
  std::atomic_thread_fence(std::memory_order_seq_cst);
  const SensoryRingReader::Range range = reader_->entries();
  if (range.end < end_) {
    close(fmt::format("it had {} entries, and then {}", end_, range.end));
    return;
  }
  end_ = range.end;
  uint64_t first = range.end;
  for (uint64_t rest = attended; rest != 0; rest &= rest - 1)
    first = std::min(first, passed_until_[static_cast<size_t>(std::countr_zero(rest))]);
  const int64_t oldest = oldest_came();
  // What lies in the ring beside each other: a client that has entries overlap asks for more.
  size_t budget = entries_->size();
  for (uint64_t sequence = std::max(first, range.first); sequence < range.end; ++sequence) {
    const auto entry = reader_->find(sequence);
    if (!entry) continue;
    if (entry->came_ns < oldest) continue;
    const uint64_t wanted = not_passed(entry->entities & attended, sequence);
    if (wanted != 0) pass_entry(*entry, wanted, budget);
    if (!reader_) return;
  }
  for (uint64_t rest = attended; rest != 0; rest &= rest - 1)
    passed_until_[static_cast<size_t>(std::countr_zero(rest))] = range.end;
  const MutexLock lock(placing_);
  // Where attention opened to more meanwhile, its own call says what was taken.
  if (openings == openings_) control_->taken = range.end;
}

void SharedRing::pass_entry(const SensoryEntry& entry, uint64_t wanted, size_t& budget) {
  uint64_t snapshots = static_cast<uint64_t>(std::popcount(wanted));
  Status status = take(entry, wanted, budget, snapshots);
  if (status.ok()) {
    counts_.passed += snapshots;
    return;
  }
  // Overwritten while it was copied: a client that keeps to the rules does so only to what is too
  // old. It is lost as any other.
  if (status.code() == StatusCode::kNotFound) return;
  log::debug("sensory ring of '{}': {}", segment_.match.to_string(), status.to_string());
  counts_.refused += snapshots;
  refused_.insert_or_assign(entry.sequence, std::move(status));
  if (refused_.size() > kMaxRefusedEntries) refused_.erase(refused_.begin());
}

Status SharedRing::take(const SensoryEntry& entry, uint64_t wanted, size_t& budget,
                        uint64_t& snapshots) {
  const auto overwritten = [] { return not_found("an entry was overwritten"); };
  if (entry.head_bytes > kMaxHeadBytes || entry.head_bytes > budget)
    return data_loss("found a head of {} bytes, needs at most {}", entry.head_bytes,
                     std::min<uint64_t>(kMaxHeadBytes, budget));
  budget -= entry.head_bytes;
  std::vector<std::byte> head(entry.head_bytes);
  if (!reader_->copy(entry, entry.data_bytes, head)) return overwritten();
  v1::CommitRequest message;
  if (!message.ParseFromArray(head.data(), static_cast<int>(head.size())))
    return data_loss("found a head that is no message");
  std::vector<std::string> names;
  {
    const MutexLock lock(placing_);
    for (uint64_t rest = wanted; rest != 0; rest &= rest - 1)
      if (const auto place = static_cast<size_t>(std::countr_zero(rest)); place < entities_.size())
        names.push_back(entities_[place]->id.to_string());
  }
  v1::CommitRequest taken;
  for (v1::Snapshot& update : *message.mutable_updates())
    if (std::ranges::find(names, update.entity()) != names.end())
      taken.mutable_updates()->Add(std::move(update));
  if (taken.updates_size() == 0 || static_cast<size_t>(taken.updates_size()) > names.size())
    return data_loss("found {} snapshots of {} entities, needs one of each", taken.updates_size(),
                     names.size());
  snapshots = static_cast<uint64_t>(taken.updates_size());
  auto data = copy_data(entry, taken, budget);
  if (!data.ok()) return data.status();
  ENGRAM_ASSIGN_OR_RETURN(WireCommit commit, take_commit(taken, *data));
  for (const ltm::EntityUpdate& update : commit.commit.updates)
    ENGRAM_RETURN_IF_ERROR(who_.check(Right::kWrite, update.entity, update.time));
  ENGRAM_ASSIGN_OR_RETURN(
      const ltm::Admission admission,
      context_.service.commit(std::move(commit.commit), std::move(commit.encoded)));
  publish(context_, admission.snapshots);
  return {};
}

Result<Buffer> SharedRing::copy_data(const SensoryEntry& entry, v1::CommitRequest& message,
                                     size_t& budget) {
  uint64_t bytes = 0;
  for (const v1::Snapshot& update : message.updates())
    for (const v1::Instance& instance : update.instances()) {
      const v1::Span& span = instance.shared();
      if (!instance.has_shared() || span.offset() > entry.data_bytes ||
          span.size() > entry.data_bytes - span.offset() || span.size() > budget)
        return data_loss("found {} bytes at {} of an entry's data, which have {}", span.size(),
                         span.offset(), entry.data_bytes);
      budget -= span.size();
      bytes += aligned_in_block(span.size());
    }
  // What others may map must hold nothing that is redacted later.
  const std::string& memory = segment_.match.names()[0];
  std::optional<SharedSessions::OwnBlock> block;
  if (bytes >= kMinBlockBytes && !context_.service.may_redact_in(memory)) {
    auto leased = context_.sharing->lease_own(memory, bytes);
    if (leased.ok()) block = *leased;
  }
  std::shared_ptr<std::byte[]> own;
  if (!block) own = std::make_shared_for_overwrite<std::byte[]>(bytes);
  const std::span<std::byte> to =
      block ? block->bytes : std::span<std::byte>(own.get(), static_cast<size_t>(bytes));
  uint64_t at = 0;
  bool is_whole = true;
  for (v1::Snapshot& update : *message.mutable_updates())
    for (v1::Instance& instance : *update.mutable_instances()) {
      v1::Span& span = *instance.mutable_shared();
      is_whole = is_whole && reader_->copy(entry, span.offset(), to.subspan(at, span.size()));
      span.set_offset(at);
      at += aligned_in_block(span.size());
    }
  if (is_whole && block) return context_.sharing->commit_own(memory, *block);
  if (is_whole) return Buffer(own, to);
  if (block) context_.sharing->abandon_own(*block);
  return not_found("an entry was overwritten");
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
  pass_attended();
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

memory::SensoryCounts SharedRing::counts() const {
  const MutexLock lock(passing_);
  memory::SensoryCounts counts = counts_;
  if (!reader_) return counts;
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
  counts.committed = reader_->snapshots();
  counts.crowded_out = reader_->crowded_out();
  return counts;
}

}  // namespace engram::server
