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

  /// The bit of an entity, which the ring may have from now on.
  /// Errors: kResourceExhausted beyond the max number of one ring; those of SensoryMemory::entity.
  Result<uint32_t> place_of(const ltm::MemoryId& entity);

  /// Begins to read what the client has mapped. Returns false if it has begun before.
  /// Errors: those of SharedPool::commit.
  Result<bool> begin();

  /// Passes what is attended to of the first `written` entries. Returns what became of the last.
  /// Errors: kFailedPrecondition if it has not begun, or the client broke it.
  Status pass_until(uint64_t written);

  /// The client is gone: what is held can still pass for its time.
  void end();

  void attention_changed() override;
  void pass() override;
  bool sweep(SteadyTime now) override;
  [[nodiscard]] memory::SensoryCounts counts() const override;

 private:
  SharedRing(RpcContext& context, Identity who, ClientId client, uint64_t id,
             const memory::SensorySegment& segment, SharedSessions::RingMemory memory);

  void pass_attended() ENGRAM_REQUIRES(passing_);
  void pass_entry(const SensoryEntry& entry, uint64_t wanted, size_t& budget)
      ENGRAM_REQUIRES(passing_);
  Status take(const SensoryEntry& entry, uint64_t wanted, size_t& budget, uint64_t& snapshots)
      ENGRAM_REQUIRES(passing_);
  /// Copies the data of a commit to one buffer of this process, and has the message say where.
  Result<Buffer> copy_data(const SensoryEntry& entry, v1::CommitRequest& message, size_t& budget)
      ENGRAM_REQUIRES(passing_);
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
  /// Why the newest of those that were refused were.
  std::map<uint64_t, Status> refused_ ENGRAM_GUARDED_BY(passing_);
  std::optional<SteadyTime> ended_ ENGRAM_GUARDED_BY(passing_);
  bool is_crowding_told_ ENGRAM_GUARDED_BY(passing_) = false;

  /// Never held for long: attention changes meanwhile.
  mutable Mutex placing_ ENGRAM_ACQUIRED_AFTER(passing_);
  std::vector<memory::SharedSensoryEntity> entities_ ENGRAM_GUARDED_BY(placing_);
  uint64_t openings_ ENGRAM_GUARDED_BY(placing_) = 0;
};

}  // namespace engram::server
