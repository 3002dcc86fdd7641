// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/mutex.h"
#include "memory/live/sensory_memory.h"
#include "server/rpc/entry_outcomes.h"
#include "server/rpc/rpc_context.h"
#include "server/sharing/sensory_ring.h"

namespace engram::server {

/// The server's side of one ring that a client writes. What it reads there is checked as what comes
/// over a stream, after it was copied.
///
/// Threading: thread-safe.
/// Source: docs/sensory.md.
class SharedRing final : public memory::SensorySource {
 public:
  /// `context` and `segment` must outlive it.
  /// Errors: those of SharedSessions::lease_ring.
  static Result<std::shared_ptr<SharedRing>> create(RpcContext& context, const Identity& who,
                                                    ClientId client, uint64_t id,
                                                    const memory::SensorySegment& segment);
  ~SharedRing() override;

  [[nodiscard]] uint64_t id() const { return id_; }
  [[nodiscard]] const memory::SensorySegment& segment() const { return segment_; }
  [[nodiscard]] const SharedSessions::RingMemory& memory() const { return memory_; }
  [[nodiscard]] bool is_closed() const { return control_->is_closed != 0; }

  /// The bits of entities, which the ring may have from now on: all of them or none.
  /// Errors: kResourceExhausted beyond the max number of one ring; those of SensoryMemory::entity.
  Result<std::vector<uint32_t>> places_of(std::span<const ltm::MemoryId> entities);

  /// Begins to read what the client has mapped. Returns false if it has begun before.
  /// Errors: those of SharedPool::commit.
  Result<bool> begin();

  /// Passes what is attended to of the first `written` entries, at least one. Returns what became
  /// of the last, to which its client saw that somebody attends.
  /// Errors: kFailedPrecondition if it has not begun, or the client broke it; kDataLoss if the last
  /// could not pass; why it was refused.
  Status pass_until(uint64_t written);

  /// The client is gone: what is held can still pass for its time.
  void end();

  void attention_changed() override;
  void pass() override;
  void pass_chosen(const memory::IsChosen& is_chosen) override;
  void note_earliest(memory::EarliestTimes& times) const override;
  bool sweep(SteadyTime now) override;
  [[nodiscard]] memory::SensoryCounts counts() const override;

 private:
  SharedRing(RpcContext& context, Identity who, ClientId client, uint64_t id,
             const memory::SensorySegment& segment, SharedSessions::RingMemory memory);

  /// A number for each entity.
  using OfPlaces = std::array<int64_t, kMaxRingEntities>;

  /// `is_counted`: what passes counts against the rate. What was held when somebody else's question
  /// or subscription opened attention does not: a second of its provider may be in it at once.
  void pass_attended(bool is_counted) ENGRAM_REQUIRES(passing_);
  /// The entries that can be read now. Nothing where the client broke the ring.
  std::optional<SensoryRingReader::Range> look() ENGRAM_REQUIRES(passing_);
  /// Passes an entry's snapshots of the `wanted` entities, as far as they are chosen (empty: all).
  /// Returns the entities of which it did, or cannot ever.
  uint64_t pass_entry(const SensoryEntry& entry, uint64_t wanted, size_t& budget, bool is_counted,
                      const memory::IsChosen& is_chosen) ENGRAM_REQUIRES(passing_);
  /// The snapshots that are to pass; `wanted` is left with their entities.
  Result<v1::CommitRequest> read_head(const SensoryEntry& entry, uint64_t& wanted, size_t& budget,
                                      const memory::IsChosen& is_chosen) ENGRAM_REQUIRES(passing_);
  Status take(const SensoryEntry& entry, v1::CommitRequest& message, size_t& budget,
              bool is_counted) ENGRAM_REQUIRES(passing_);
  /// Counts a call against the rate, unless an entry was counted that it may be of.
  Status count_call() ENGRAM_REQUIRES(passing_);
  /// When what can still pass came, at the earliest. Unit: ns of the clock that is never set.
  [[nodiscard]] int64_t oldest_came() const;
  void close(const std::string& why) ENGRAM_REQUIRES(passing_);
  /// The entities of these that did not pass at this entry already.
  [[nodiscard]] uint64_t not_passed(uint64_t entities, uint64_t sequence) const
      ENGRAM_REQUIRES(passing_);

  RpcContext& context_;
  const Identity who_;
  const ClientId client_;
  const uint64_t id_;
  const memory::SensorySegment& segment_;
  const SharedSessions::RingMemory memory_;
  SensoryControl* const control_;  ///< In `memory_`.

  /// Held while entries pass: nobody overtakes them.
  mutable Mutex passing_;
  std::optional<Buffer> entries_ ENGRAM_GUARDED_BY(passing_);
  std::optional<SensoryRingReader> reader_ ENGRAM_GUARDED_BY(passing_);
  /// The first entry that did not pass, of each entity. Others of an entry may pass later.
  std::array<uint64_t, kMaxRingEntities> passed_until_ ENGRAM_GUARDED_BY(passing_){};
  uint64_t end_ ENGRAM_GUARDED_BY(passing_) = 0;  ///< As it was read last: it never goes back.
  memory::SensoryCounts counts_ ENGRAM_GUARDED_BY(passing_);
  /// The entities of entries that passed ahead of others before them.
  std::map<uint64_t, uint64_t> passed_early_ ENGRAM_GUARDED_BY(passing_);
  EntryOutcomes outcomes_ ENGRAM_GUARDED_BY(passing_);
  /// Entries that counted against the rate, whose own calls may come yet.
  uint64_t untold_ ENGRAM_GUARDED_BY(passing_) = 0;
  std::optional<SteadyTime> ended_ ENGRAM_GUARDED_BY(passing_);
  bool is_crowding_told_ ENGRAM_GUARDED_BY(passing_) = false;

  /// Never held for long: attention changes meanwhile.
  mutable Mutex placing_ ENGRAM_ACQUIRED_AFTER(passing_);
  std::vector<memory::SharedSensoryEntity> entities_ ENGRAM_GUARDED_BY(placing_);
  uint64_t openings_ ENGRAM_GUARDED_BY(placing_) = 0;
  /// When what passes came at the earliest, since attention to it opened. Unit: as oldest_came().
  OfPlaces oldest_passed_ ENGRAM_GUARDED_BY(placing_){};
};

}  // namespace engram::server
