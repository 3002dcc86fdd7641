// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <thread>

#include "ltm/core/mutex.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// Makes the indexes of segments as they are sealed, so that questions do not wait for a night:
/// places and links of all entities, and codes of the images of those that have a space. It learns
/// no space.
///
/// It works in a thread of its own with lower priority and takes a quarter of a core at most, so
/// that nothing that records waits for it. What it does not come to is left to the next night: what
/// a killed or closed program had not coded yet, what comes faster than it codes, what cannot be
/// read.
///
/// Threading: thread-safe.
/// Source: docs/recall.md, section "Codes"; docs/query.md, "How they are answered".
class SealedIndexer {
 public:
  explicit SealedIndexer(std::filesystem::path store);
  /// Ends after the image at hand.
  ~SealedIndexer();

  /// Takes a segment, as AfterSeal names it, and returns at once.
  void add(const std::string& segment_file) ENGRAM_EXCLUDES(mutex_);

  /// Waits until all that was taken is coded, with all of a core from now on, or for `stop`.
  void finish(const std::stop_token& stop = {}) ENGRAM_EXCLUDES(mutex_);

  struct Counters {
    uint64_t coded = 0;  ///< Images.
    uint64_t left = 0;   ///< Segments that were left to the next night.
  };
  [[nodiscard]] Counters counters() const { return {coded_, left_}; }

 private:
  void run(const std::stop_token& stop) ENGRAM_EXCLUDES(mutex_);
  Status code(const std::string& segment_file, const std::stop_token& stop);
  /// Waits so long that this thread works a quarter of the time.
  void rest(Duration worked, const std::stop_token& stop) ENGRAM_EXCLUDES(mutex_);

  const std::filesystem::path store_;
  std::atomic<uint64_t> coded_{0};
  std::atomic<uint64_t> left_{0};
  Mutex mutex_;
  StoppableCondition changed_;
  std::deque<std::string> waiting_ ENGRAM_GUARDED_BY(mutex_);
  bool is_coding_ ENGRAM_GUARDED_BY(mutex_) = false;
  bool is_hurried_ ENGRAM_GUARDED_BY(mutex_) = false;
  std::jthread thread_;  ///< Last: it uses all the others.
};

}  // namespace engram::ltm
