// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/core/time.h"
#include "ltm/memory/commit.h"

namespace engram::memory {

/// Entities whose snapshots are held for a short time and pass to working memory only while
/// somebody attends.
struct SensorySegment {
  ltm::MemoryId match;  ///< A memory, a segment or an entity, and all below it.
  Duration hold{};      ///< How long a snapshot can still pass after it came.
};

/// An entity of a sensory segment. The sources that have had snapshots of it share it.
///
/// Threading: thread-safe.
class SensoryEntity {
 public:
  SensoryEntity(ltm::MemoryId named, Duration held) : id(std::move(named)), hold(held) {}

  const ltm::MemoryId id;
  const Duration hold;

  [[nodiscard]] bool is_attended() const { return is_attended_; }

 private:
  friend class SensoryMemory;
  std::atomic<bool> is_attended_{false};
  int attentions_ = 0;           ///< Those open now. The memory's lock guards it and the next.
  SteadyTime attended_until_{};  ///< Queries attend until then.
};

using SharedSensoryEntity = std::shared_ptr<SensoryEntity>;

/// What came to sources of sensory memory and what became of it. Unit: snapshots, unless named.
///
/// committed = passed + refused + lost + held.
struct SensoryCounts {
  uint64_t committed = 0;
  uint64_t passed = 0;   ///< Working memory took them.
  uint64_t refused = 0;  ///< They were to pass, and working memory or a right refused them.
  /// Lost before their time, because the source had no room for what came after them.
  uint64_t crowded_out = 0;
  uint64_t held = 0;        ///< They can still pass.
  uint64_t held_bytes = 0;  ///< Of these.

  [[nodiscard]] uint64_t lost() const {
    const uint64_t known = passed + refused + held;
    return committed > known ? committed - known : 0;
  }
};

/// Gives a commit to working memory, and tells subscribers.
using PassCommit =
    std::function<Status(ltm::Commit commit, std::vector<std::vector<Buffer>> encoded)>;

/// Which snapshots are to pass.
using IsChosen = std::function<bool(const ltm::MemoryId& entity, Time time)>;

/// The earliest time of what is held of each entity.
class EarliestTimes {
 public:
  void note(const ltm::MemoryId& entity, Time time) {
    Time& known = times_.try_emplace(entity, time).first->second;
    known = std::min(known, time);
  }

  /// Nothing if nothing is held.
  [[nodiscard]] std::optional<Time> of(const ltm::MemoryId& entity) const {
    const auto known = times_.find(entity);
    return known == times_.end() ? std::nullopt : std::optional(known->second);
  }

 private:
  std::unordered_map<ltm::MemoryId, Time> times_;
};

/// One place where snapshots of sensory segments are held, such as the ring of one provider.
///
/// A snapshot passes once at most, and in the order in which it came: attention_changed() is called
/// first, so that nothing is lost from then on, then pass().
/// Threading: thread-safe.
class SensorySource {
 public:
  virtual ~SensorySource() = default;

  /// Called after attention to some entity opened or closed. Must not wait for pass().
  virtual void attention_changed() {}

  /// Passes what it holds of attended entities and came within their time to be held. Returns
  /// once all of it has passed, also where another thread does so.
  virtual void pass() = 0;

  /// Passes what it holds and is chosen, whoever attends. Others stay where they are.
  virtual void pass_chosen(const IsChosen& is_chosen) = 0;

  /// Notes the times of what it holds and did not pass.
  virtual void note_earliest(EarliestTimes& times) const = 0;

  /// Called at intervals: lets go of what is too old. Returns false if the source is of no use any
  /// more.
  virtual bool sweep(SteadyTime now) = 0;

  [[nodiscard]] virtual SensoryCounts counts() const = 0;
};

}  // namespace engram::memory
