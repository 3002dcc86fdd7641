// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <thread>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/core/time.h"
#include "ltm/store/journal.h"

namespace engram::ltm {

/// Forces journals to the disk at a fixed interval, on a thread of its own, so that appending does
/// not wait for the disk.
///
/// Threading: thread-safe.
class JournalSyncer {
 public:
  explicit JournalSyncer(Duration interval);
  ~JournalSyncer();

  /// Records that data was appended to `journal`. It is forced to the disk at the next interval.
  /// `bytes` is its size now.
  void note_append(const std::shared_ptr<Journal>& journal, uint64_t bytes);

  /// Returns ok if everything appended before the last interval is on the disk. Each error is
  /// returned once.
  Status take_error();

 private:
  void run(const std::stop_token& stop);

  struct Dirty {
    std::shared_ptr<Journal> journal;
    uint64_t bytes = 0;  ///< Its size after the last append.
  };

  const Duration interval_;
  Mutex mutex_;
  StoppableCondition changed_;
  /// Journals that were appended to since they were last forced to the disk.
  std::vector<Dirty> dirty_ ENGRAM_GUARDED_BY(mutex_);
  Status error_ ENGRAM_GUARDED_BY(mutex_);
  std::jthread thread_;  ///< Last: it uses all the others.
};

}  // namespace engram::ltm
