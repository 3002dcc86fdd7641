// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <thread>
#include <utility>

#include "ltm/core/mutex.h"
#include "ltm/core/status.h"

namespace engram {

/// Calls a function repeatedly in a thread of its own, ahead of the consumer of its items.
///
/// Items come in order, up to the first one without a value or with an error, which is then
/// repeated. At most `limit` bytes of items wait (or a single item of any size), and at most 256
/// items.
/// Threading: one thread calls next(). The function runs in another thread until it has no more
/// items or this object is destroyed. It must not throw.
template <typename T>
class ReadAhead {
 public:
  using Item = Result<std::optional<T>>;

  /// `size_of` estimates the size of an item. Unit: bytes.
  ReadAhead(std::function<Item()> read, std::function<size_t(const T&)> size_of, size_t limit)
      : read_(std::move(read)), size_of_(std::move(size_of)), limit_(limit) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }

  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  Item next() {
    MutexLock lock(mutex_);
    changed_.wait(mutex_, [this]() ENGRAM_REQUIRES(mutex_) { return !waiting_.empty(); });
    if (const Item& front = waiting_.front().item; !front.ok())
      return front.status();
    else if (!*front)
      return std::optional<T>();
    Waiting first = std::move(waiting_.front());
    waiting_.pop_front();
    bytes_ -= first.bytes;
    lock.unlock();
    changed_.notify_all();
    return std::move(first.item);
  }

 private:
  static constexpr size_t kMaxItems = 256;

  struct Waiting {
    Item item;
    size_t bytes = 0;
  };

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      Item item = read_();
      const bool is_last = !item.ok() || !*item;
      const size_t bytes = is_last ? 0 : size_of_(**item);
      MutexLock lock(mutex_);
      const bool has_room = changed_.wait(mutex_, stop, [&]() ENGRAM_REQUIRES(mutex_) {
        return waiting_.empty() || (bytes_ + bytes <= limit_ && waiting_.size() < kMaxItems);
      });
      if (!has_room) return;
      waiting_.push_back({std::move(item), bytes});
      bytes_ += bytes;
      lock.unlock();
      changed_.notify_all();
      if (is_last) return;
    }
  }

  const std::function<Item()> read_;
  const std::function<size_t(const T&)> size_of_;
  const size_t limit_;

  Mutex mutex_;
  StoppableCondition changed_;
  std::deque<Waiting> waiting_ ENGRAM_GUARDED_BY(mutex_);
  size_t bytes_ ENGRAM_GUARDED_BY(mutex_) = 0;

  std::jthread thread_;  ///< The last member, because it uses all others.
};

}  // namespace engram
