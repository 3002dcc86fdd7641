// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <thread>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/core/time.h"
#include "ltm/store/journal.h"

namespace engram::ltm {

/// Forces a journal to the disk every so often, on a thread of its own: who appends does not wait.
///
/// Threading: thread-safe.
class JournalSyncer {
 public:
  explicit JournalSyncer(Duration interval);
  ~JournalSyncer();

  /// `journal` was appended to.
  void note_append(const std::shared_ptr<Journal>& journal);

  /// Ok where everything up to the last interval is on the disk. An error is told once.
  Status take_error();

 private:
  void run(const std::stop_token& stop);

  const Duration interval_;
  Mutex mutex_;
  StoppableCondition changed_;
  /// Appended to since they were forced.
  std::vector<std::shared_ptr<Journal>> dirty_ ENGRAM_GUARDED_BY(mutex_);
  Status error_ ENGRAM_GUARDED_BY(mutex_);
  std::jthread thread_;  ///< Last: it uses all the others.
};

}  // namespace engram::ltm
