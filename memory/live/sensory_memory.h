// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/memory/query.h"
#include "ltm/memory/sight.h"
#include "memory/live/plain_ring.h"
#include "memory/live/sensory_source.h"

namespace engram::memory {

class SensoryMemory;

/// Somebody attends to entities as long as this lives. An empty one attends to nothing.
///
/// Threading: one thread. It may outlive the memory.
class Attention {
 public:
  Attention() = default;
  Attention(Attention&& other) noexcept = default;
  Attention& operator=(Attention&& other) noexcept;
  ~Attention() { end(); }

  void end();

 private:
  friend class SensoryMemory;
  Attention(std::weak_ptr<SensoryMemory> memory, uint64_t number)
      : memory_(std::move(memory)), number_(number) {}

  std::weak_ptr<SensoryMemory> memory_;
  uint64_t number_ = 0;
};

/// What precedes working memory: snapshots of sensory segments are held for a very short time and
/// lost, unless somebody attends to their entity. When attention opens, what is held passes to
/// working memory, and from then on what comes passes at once.
///
/// Threading: thread-safe.
/// Source: docs/sensory.md.
class SensoryMemory : public std::enable_shared_from_this<SensoryMemory> {
 public:
  struct Options {
    std::vector<SensorySegment> segments;  ///< Empty: nothing is sensory.
    /// The max size of what one provider's ring holds, and of what the server holds of one segment
    /// for providers without a ring. Unit: bytes.
    size_t ring_bytes = size_t{64} << 20;
    /// How long a query attends; empty: as long as the segment holds.
    std::optional<Duration> query_attention;

    /// Errors: kInvalidArgument naming the segment.
    [[nodiscard]] Status validate() const;
  };

  /// The max number of entities that it knows: each query looks at all of them.
  static constexpr size_t kMaxEntities = 4096;
  static constexpr Duration kMinHold = std::chrono::milliseconds(1);
  static constexpr Duration kMaxHold = std::chrono::seconds(10);
  static constexpr size_t kMinRingBytes = size_t{64} << 10;
  static constexpr size_t kMaxRingBytes = size_t{256} << 20;
  /// Questions about times that ended longer ago do not attend. Times of snapshots and the clock
  /// may differ by less.
  static constexpr Duration kRecent = std::chrono::minutes(1);

  /// Whether somebody attends to an entity; asked once of each.
  using Wanted = std::function<bool(const ltm::MemoryId& entity)>;

  /// Needs options that validate. `max_entities` bounds what it knows if it is less than
  /// kMaxEntities, `clock` tells which times are recent.
  static std::shared_ptr<SensoryMemory> create(const Options& options, size_t max_entities,
                                               PassCommit pass, Clock clock);

  [[nodiscard]] const Options& options() const { return options_; }

  /// The segment of an entity; null if it is not sensory. Of several that match the longest ID
  /// counts.
  [[nodiscard]] const SensorySegment* segment_of(const ltm::MemoryId& entity) const;

  /// The entity, which is known from now on. Needs one of a sensory segment (checked).
  /// Errors: kResourceExhausted beyond the max number.
  Result<SharedSensoryEntity> entity(const ltm::MemoryId& id);

  /// Opens attention to the entities that `is_wanted` says, also to those that come later. What is
  /// held of them has passed when this returns.
  [[nodiscard]] Attention attend(Wanted is_wanted);

  /// Attends for a short time to the entities that a query selects and `view` sees (null: all),
  /// unless all that it asks for lies before what is held. It returns as attend() does.
  void attend(const ltm::Query& query, const ltm::View* view);

  /// Passes what is held, a query may select and `view` sees. Nobody attends to what comes later,
  /// and all else stays where it is.
  void pass_chosen(const ltm::Query& query, const ltm::View* view);

  /// Whether attend() may have something pass, which takes long.
  [[nodiscard]] bool selects(const ltm::Query& query, const ltm::View* view) const;

  /// Takes the updates of sensory entities to which nobody attends out of a commit, and holds them.
  /// `encoded` is as of WorkingMemory::admit().
  /// Errors: those of Commit::check() and entity(); kResourceExhausted for more bytes than it may
  /// hold. Nothing is held then.
  Status hold(ltm::Commit& commit, std::vector<std::vector<Buffer>>& encoded);

  /// Adds a source. It stays until its sweep() says so or remove() is called, which waits until it
  /// passes nothing.
  void add(std::shared_ptr<SensorySource> source);
  void remove(const SensorySource* source);

  /// To be called at intervals: ends the attention of queries, and lets go of what is too old.
  void sweep(SteadyTime now);

  /// Lets go of everything; nothing passes any more.
  void close();

  [[nodiscard]] SensoryCounts counts() const;
  [[nodiscard]] size_t source_count() const;

 private:
  friend class Attention;
  struct Opened {
    Wanted is_wanted;
    std::vector<SharedSensoryEntity> entities;
  };
  using Sources = std::vector<std::shared_ptr<SensorySource>>;

  SensoryMemory(const Options& options, size_t max_entities, PassCommit pass, Clock clock);
  void end(uint64_t number) ENGRAM_EXCLUDES(mutex_);
  /// Returns whether it is attended to anew, or not any more.
  static bool settle(SensoryEntity& entity, SteadyTime now);
  void tell_sources() ENGRAM_REQUIRES(mutex_);
  [[nodiscard]] EarliestTimes earliest_held() const;
  /// The entities to which a query attends.
  [[nodiscard]] std::vector<SharedSensoryEntity> asked_for(const ltm::Query& query,
                                                           const ltm::View* view) const;
  static SensoryCounts add_up(const SensoryCounts& first, const SensoryCounts& second);
  /// Counts what a source did that is gone.
  void keep_counts(const SensorySource& gone) ENGRAM_REQUIRES(mutex_);
  PlainRing& ring_of(const ltm::MemoryId& entity);

  const Options options_;
  const size_t max_entities_;
  const Clock clock_;
  /// One of each segment, for providers without a ring of their own.
  std::vector<std::shared_ptr<PlainRing>> plain_;

  mutable Mutex mutex_;
  std::unordered_map<ltm::MemoryId, SharedSensoryEntity> entities_ ENGRAM_GUARDED_BY(mutex_);
  std::map<uint64_t, Opened> opened_ ENGRAM_GUARDED_BY(mutex_);
  uint64_t last_opened_ ENGRAM_GUARDED_BY(mutex_) = 0;
  Sources sources_ ENGRAM_GUARDED_BY(mutex_);
  SensoryCounts of_gone_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::memory
