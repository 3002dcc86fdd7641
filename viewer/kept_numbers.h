// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/store/entity_times.h"

namespace engram::viewer {

/// One number of all snapshots of an entity, as far as they were read.
///
/// Threading: thread-safe; what two threads read at once is the same number.
class NumberColumn {
 public:
  explicit NumberColumn(size_t count) : numbers_(count, unread()) {}

  [[nodiscard]] size_t size() const { return numbers_.size(); }
  [[nodiscard]] bool is_whole() const { return read_ == numbers_.size(); }

  /// The number of a snapshot: NaN where it has none or was not read.
  [[nodiscard]] float at(size_t snapshot) const {
    return std::atomic_ref(const_cast<float&>(numbers_[snapshot])).load(std::memory_order_relaxed);
  }
  [[nodiscard]] bool was_read(size_t snapshot) const { return bits(at(snapshot)) != kUnread; }

  void put(size_t snapshot, float number) {
    const float kept = std::isnan(number) ? std::numeric_limits<float>::quiet_NaN() : number;
    const float before = std::atomic_ref(numbers_[snapshot]).exchange(kept);
    if (bits(before) == kUnread) ++read_;
  }

 private:
  static constexpr uint32_t kUnread = 0x7FC0'0001;  ///< A NaN that put() never keeps.
  static float unread() { return std::bit_cast<float>(kUnread); }
  static uint32_t bits(float number) { return std::bit_cast<uint32_t>(number); }

  std::vector<float> numbers_;
  std::atomic<size_t> read_ = 0;
};

/// Numbers of one entity in one state of a store, so that each is read once. They are kept in
/// memory alone: what is forgotten must not stay in a cache on the disk.
///
/// Threading: thread-safe.
class KeptNumbers {
 public:
  explicit KeptNumbers(std::shared_ptr<const ltm::EntityTimes> times) : times_(std::move(times)) {}

  [[nodiscard]] const ltm::EntityTimes& times() const { return *times_; }

  /// The number at a path of an instance; `path` is that of a ShownMember.
  std::shared_ptr<NumberColumn> column(size_t instance, const std::string& path)
      ENGRAM_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    auto& column = columns_[{instance, path}];
    if (column == nullptr) column = std::make_shared<NumberColumn>(times_->all.size());
    return column;
  }

  [[nodiscard]] size_t held_bytes() const ENGRAM_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return columns_.size() * times_->all.size() * sizeof(float);
  }

 private:
  const std::shared_ptr<const ltm::EntityTimes> times_;
  mutable Mutex mutex_;
  std::map<std::pair<size_t, std::string>, std::shared_ptr<NumberColumn>> columns_
      ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::viewer
