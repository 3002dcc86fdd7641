// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <shared_mutex>
#include <stop_token>
#include <utility>

#include "ltm/core/thread_annotations.h"

namespace engram {

/// A std::mutex that clang's analysis knows: members say by ENGRAM_GUARDED_BY that it guards them.
///
/// Every mutex of the project is one of these or a SharedMutex; none is recursive.
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

/// Holds a mutex as long as it lives, but for the time between unlock() and lock().
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

/// Holds a shared mutex alone as long as it lives.
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

/// Holds a shared mutex with other readers as long as it lives.
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

/// A mutex that is held already, as the standard library wants it; it stays held.
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

/// Waits until something holds of what a mutex guards. Who waits holds the mutex, which is free
/// meanwhile; the predicate is called with it held, and says so:
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

  /// What the predicate says at the end.
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

/// The same, whose waits also end where a stop is requested. Costs a second mutex per object, which
/// each notification takes.
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

  /// What the predicate says at the end: false where the stop came first.
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
