// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <shared_mutex>
#include <stop_token>
#include <utility>

#include "ltm/core/thread_annotations.h"

namespace engram {

/// A std::mutex for clang's thread safety analysis: members declare by ENGRAM_GUARDED_BY that it
/// guards them.
///
/// Every mutex of the project is a Mutex or a SharedMutex; none is recursive.
/// Threading: thread-safe.
class ENGRAM_CAPABILITY("mutex") Mutex {
 public:
  Mutex() = default;
  Mutex(const Mutex&) = delete;
  Mutex& operator=(const Mutex&) = delete;

  void lock() ENGRAM_ACQUIRE() { mutex_.lock(); }
  void unlock() ENGRAM_RELEASE() { mutex_.unlock(); }

 private:
  friend class BorrowedMutex;
  std::mutex mutex_;
};

/// Holds a mutex as long as it lives, except between unlock() and lock().
///
/// Threading: one thread.
class ENGRAM_SCOPED_CAPABILITY MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) ENGRAM_ACQUIRE(mutex) : mutex_(mutex) { mutex_.lock(); }
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;
  ~MutexLock() ENGRAM_RELEASE() {
    if (is_held_) mutex_.unlock();
  }

  void unlock() ENGRAM_RELEASE() {
    is_held_ = false;
    mutex_.unlock();
  }
  void lock() ENGRAM_ACQUIRE() {
    mutex_.lock();
    is_held_ = true;
  }

 private:
  Mutex& mutex_;
  bool is_held_ = true;
};

/// A std::shared_mutex: many readers, or one writer.
///
/// Threading: thread-safe.
class ENGRAM_CAPABILITY("shared mutex") SharedMutex {
 public:
  SharedMutex() = default;
  SharedMutex(const SharedMutex&) = delete;
  SharedMutex& operator=(const SharedMutex&) = delete;

  void lock() ENGRAM_ACQUIRE() { mutex_.lock(); }
  void unlock() ENGRAM_RELEASE() { mutex_.unlock(); }
  void lock_shared() ENGRAM_ACQUIRE_SHARED() { mutex_.lock_shared(); }
  void unlock_shared() ENGRAM_RELEASE_SHARED() { mutex_.unlock_shared(); }

 private:
  std::shared_mutex mutex_;
};

/// Holds a shared mutex exclusively as long as it lives.
class ENGRAM_SCOPED_CAPABILITY ExclusiveLock {
 public:
  explicit ExclusiveLock(SharedMutex& mutex) ENGRAM_ACQUIRE(mutex) : mutex_(mutex) {
    mutex_.lock();
  }
  ExclusiveLock(const ExclusiveLock&) = delete;
  ExclusiveLock& operator=(const ExclusiveLock&) = delete;
  ~ExclusiveLock() ENGRAM_RELEASE() { mutex_.unlock(); }

 private:
  SharedMutex& mutex_;
};

/// Holds a shared mutex together with other readers as long as it lives.
class ENGRAM_SCOPED_CAPABILITY SharedLock {
 public:
  explicit SharedLock(SharedMutex& mutex) ENGRAM_ACQUIRE_SHARED(mutex) : mutex_(mutex) {
    mutex_.lock_shared();
  }
  SharedLock(const SharedLock&) = delete;
  SharedLock& operator=(const SharedLock&) = delete;
  ~SharedLock() ENGRAM_RELEASE_GENERIC() { mutex_.unlock_shared(); }

 private:
  SharedMutex& mutex_;
};

/// Adapts a mutex that is already held to the standard library. The mutex stays held.
class BorrowedMutex {
 public:
  explicit BorrowedMutex(Mutex& mutex) : lock_(mutex.mutex_, std::adopt_lock) {}
  BorrowedMutex(const BorrowedMutex&) = delete;
  BorrowedMutex& operator=(const BorrowedMutex&) = delete;
  ~BorrowedMutex() { lock_.release(); }

  std::unique_lock<std::mutex>& lock() { return lock_; }

 private:
  std::unique_lock<std::mutex> lock_;
};

/// Waits until a predicate on what a mutex guards is true. The caller holds the mutex, which is
/// released while it waits. The predicate runs with the mutex held, and declares this:
///
///     changed_.wait(mutex_, [this]() ENGRAM_REQUIRES(mutex_) { return !waiting_.empty(); });
///
/// Threading: thread-safe.
class ConditionVariable {
 public:
  void notify_one() { condition_.notify_one(); }
  void notify_all() { condition_.notify_all(); }

  template <typename Predicate>
  void wait(Mutex& mutex, Predicate predicate) ENGRAM_REQUIRES(mutex) {
    BorrowedMutex held(mutex);
    condition_.wait(held.lock(), std::move(predicate));
  }

  /// Returns the value of the predicate at the end.
  template <typename Length, typename Predicate>
  bool wait_for(Mutex& mutex, Length time, Predicate predicate) ENGRAM_REQUIRES(mutex) {
    BorrowedMutex held(mutex);
    return condition_.wait_for(held.lock(), time, std::move(predicate));
  }

  template <typename Moment, typename Predicate>
  bool wait_until(Mutex& mutex, Moment deadline, Predicate predicate) ENGRAM_REQUIRES(mutex) {
    BorrowedMutex held(mutex);
    return condition_.wait_until(held.lock(), deadline, std::move(predicate));
  }

 private:
  std::condition_variable condition_;
};

/// A ConditionVariable whose waits also end when a stop is requested. It costs a second mutex per
/// object, which each notification takes.
///
/// Threading: thread-safe.
class StoppableCondition {
 public:
  void notify_one() { condition_.notify_one(); }
  void notify_all() { condition_.notify_all(); }

  template <typename Predicate>
  void wait(Mutex& mutex, Predicate predicate) ENGRAM_REQUIRES(mutex) {
    BorrowedMutex held(mutex);
    condition_.wait(held.lock(), std::move(predicate));
  }

  /// Returns the value of the predicate at the end: false where the stop came first.
  template <typename Predicate>
  bool wait(Mutex& mutex, const std::stop_token& stop, Predicate predicate) ENGRAM_REQUIRES(mutex) {
    BorrowedMutex held(mutex);
    return condition_.wait(held.lock(), stop, std::move(predicate));
  }

  template <typename Length, typename Predicate>
  bool wait_for(Mutex& mutex, const std::stop_token& stop, Length time, Predicate predicate)
      ENGRAM_REQUIRES(mutex) {
    BorrowedMutex held(mutex);
    return condition_.wait_for(held.lock(), stop, time, std::move(predicate));
  }

  template <typename Moment, typename Predicate>
  bool wait_until(Mutex& mutex, const std::stop_token& stop, Moment deadline, Predicate predicate)
      ENGRAM_REQUIRES(mutex) {
    BorrowedMutex held(mutex);
    return condition_.wait_until(held.lock(), stop, deadline, std::move(predicate));
  }

 private:
  std::condition_variable_any condition_;
};

}  // namespace engram
