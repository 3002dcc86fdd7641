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
#include <tuple>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/store/entity_times.h"

namespace engram::viewer {

/// One number of the snapshots of an entity, of each `stride`-th one, as far as they were read.
///
/// Threading: thread-safe; what two threads read at once is the same number.
class NumberColumn {
 public:
  NumberColumn(size_t snapshots, size_t stride)
      : stride_(stride), numbers_((snapshots + stride - 1) / stride, unread()) {}

  /// Of so many snapshots it has the number of the first.
  [[nodiscard]] size_t stride() const { return stride_; }

  [[nodiscard]] size_t size() const { return numbers_.size(); }
  [[nodiscard]] bool is_whole() const { return read_ == numbers_.size(); }

  /// The number of snapshot `i` * stride(): NaN where it has none or was not read.
  [[nodiscard]] float at(size_t i) const {
    return std::atomic_ref(const_cast<float&>(numbers_[i])).load(std::memory_order_relaxed);
  }
  [[nodiscard]] bool was_read(size_t i) const { return bits(at(i)) != kUnread; }

  void put(size_t i, float number) {
    const float kept = std::isnan(number) ? std::numeric_limits<float>::quiet_NaN() : number;
    const float before = std::atomic_ref(numbers_[i]).exchange(kept);
    if (bits(before) == kUnread) ++read_;
  }

 private:
  static constexpr uint32_t kUnread = 0x7FC0'0001;  ///< A NaN that put() never keeps.
  static float unread() { return std::bit_cast<float>(kUnread); }
  static uint32_t bits(float number) { return std::bit_cast<uint32_t>(number); }

  const size_t stride_;
  std::vector<float> numbers_;
  std::atomic<size_t> read_ = 0;
};

/// Numbers of one entity in one state of a store, so that each is read once. They are kept in
/// memory alone: what is forgotten must not stay in a cache on the disk.
///
/// Threading: thread-safe.
class KeptNumbers {
 public:
  /// At most `max_bytes` of numbers are kept.
  KeptNumbers(std::shared_ptr<const ltm::EntityTimes> times, size_t max_bytes)
      : times_(std::move(times)), max_bytes_(max_bytes) {}

  [[nodiscard]] const ltm::EntityTimes& times() const { return *times_; }

  /// The numbers at paths of an instance, all with one stride, and as many of them as fit; a path
  /// is that of a ShownMember. Others are dropped where they do not fit beside these.
  std::vector<std::shared_ptr<NumberColumn>> columns(size_t instance,
                                                     const std::vector<std::string>& paths)
      ENGRAM_EXCLUDES(mutex_);

  [[nodiscard]] size_t held_bytes() const ENGRAM_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return bytes_;
  }

 private:
  using Key = std::tuple<size_t, size_t, std::string>;  ///< Stride, instance and path.

  const std::shared_ptr<const ltm::EntityTimes> times_;
  const size_t max_bytes_;
  mutable Mutex mutex_;
  std::map<Key, std::shared_ptr<NumberColumn>> columns_ ENGRAM_GUARDED_BY(mutex_);
  size_t bytes_ ENGRAM_GUARDED_BY(mutex_) = 0;
};

}  // namespace engram::viewer
