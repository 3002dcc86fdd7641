// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>

#include "ltm/core/mutex.h"
#include "memory/live/event_queue.h"
#include "memory/memory.h"

namespace engram::python {

/// What a memory told and Python has not taken yet. Where it is too much the oldest goes, and is
/// counted. Shared by who tells and who takes: either may go first.
///
/// Threading: thread-safe; touches nothing of Python.
class Inbox {
 public:
  /// What is told of at once.
  struct Told {
    ToldSnapshot snapshot;
    uint64_t lost = 0;              ///< Not told since the one before.
    std::string interruption = {};  ///< Why what came since the one before may be missing.
  };

  explicit Inbox(size_t bound);

  [[nodiscard]] static SubscriptionHandlers handlers(const std::shared_ptr<Inbox>& inbox);

  /// Waits so long at most. Nothing where nothing came, or where it is closed.
  std::optional<Told> take(Duration max_wait);

  /// Nothing more is told, and nobody waits.
  void close();
  [[nodiscard]] bool is_closed() const;

  /// Since it was made: what was not told, and how often the server was lost.
  [[nodiscard]] uint64_t lost() const;
  [[nodiscard]] uint64_t interruptions() const;

 private:
  void put(std::vector<ToldSnapshot> told);

  mutable Mutex mutex_;
  ConditionVariable changed_;
  memory::EventQueue<ToldSnapshot> waiting_ ENGRAM_GUARDED_BY(mutex_);
  /// By the memory; the queue counts its own.
  uint64_t lost_before_ ENGRAM_GUARDED_BY(mutex_) = 0;
  uint64_t told_lost_ ENGRAM_GUARDED_BY(mutex_) = 0;
  uint64_t interruptions_ ENGRAM_GUARDED_BY(mutex_) = 0;
  std::string interruption_ ENGRAM_GUARDED_BY(mutex_);
  bool is_closed_ ENGRAM_GUARDED_BY(mutex_) = false;
};

/// A subscription that Python iterates over.
///
/// Errors: exceptions of engram.errors.
/// Threading: any thread; waits without the GIL.
class Watch {
 public:
  Watch(std::shared_ptr<Inbox> inbox, std::unique_ptr<Subscription> subscription);
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  ~Watch();

  /// {"snapshot", "has_data", "lost", "interruption"}; None where nothing came within `timeout`
  /// (ns, None: waits on), or where it is closed. Signals are looked at while it waits: Ctrl-C
  /// raises KeyboardInterrupt.
  pybind11::object next(std::optional<int64_t> timeout);

  void close();
  [[nodiscard]] bool is_closed() const { return inbox_->is_closed(); }
  [[nodiscard]] uint64_t lost() const { return inbox_->lost(); }
  [[nodiscard]] uint64_t interruptions() const { return inbox_->interruptions(); }

 private:
  const int process_;  ///< That made it: its threads do not survive a fork.
  const std::shared_ptr<Inbox> inbox_;
  Mutex mutex_;
  std::unique_ptr<Subscription> subscription_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::python
