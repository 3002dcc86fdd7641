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

/// The snapshots that a memory delivered and Python has not taken yet. If there are too many, the
/// oldest is dropped and counted. It is shared by producer and consumer, since either may end
/// first.
///
/// Threading: thread-safe; uses no Python object.
class Inbox {
 public:
  /// One delivered snapshot.
  struct Told {
    ToldSnapshot snapshot;
    uint64_t lost = 0;  ///< Snapshots lost since the one before.
    /// Why snapshots since the one before may be missing; empty if none are.
    std::string interruption = {};
  };

  explicit Inbox(size_t bound);

  [[nodiscard]] static SubscriptionHandlers handlers(const std::shared_ptr<Inbox>& inbox);

  /// Waits for a snapshot for `max_wait` at most. Returns nothing if none came, or once it is
  /// closed.
  std::optional<Told> take(Duration max_wait);

  /// Stops deliveries and wakes every waiting thread.
  void close();
  [[nodiscard]] bool is_closed() const;

  /// Total number of lost snapshots, and of lost connections to the server.
  [[nodiscard]] uint64_t lost() const;
  [[nodiscard]] uint64_t interruptions() const;

 private:
  void put(std::vector<ToldSnapshot> told);

  mutable Mutex mutex_;
  ConditionVariable changed_;
  memory::EventQueue<ToldSnapshot> waiting_ ENGRAM_GUARDED_BY(mutex_);
  /// Losses that the memory reported; the queue counts its own.
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

  /// The next event: {"snapshot", "has_data", "lost", "interruption"}, or None if nothing came
  /// within `timeout` (ns; None: no limit) or the watch is closed. Signals are checked while it
  /// waits: Ctrl-C raises KeyboardInterrupt.
  pybind11::object next(std::optional<int64_t> timeout);

  void close();
  [[nodiscard]] bool is_closed() const { return inbox_->is_closed(); }
  [[nodiscard]] uint64_t lost() const { return inbox_->lost(); }
  [[nodiscard]] uint64_t interruptions() const { return inbox_->interruptions(); }

 private:
  const int process_;  ///< The process that created it: its threads do not survive a fork.
  const std::shared_ptr<Inbox> inbox_;
  Mutex mutex_;
  std::unique_ptr<Subscription> subscription_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::python
