// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <thread>
#include <vector>

#include "ltm/codec/seal_rules.h"
#include "ltm/core/mutex.h"
#include "ltm/store/manifest.h"

namespace engram::ltm {

/// The rules of an entity. Called from the sealer's thread.
using SealRulesOf = std::function<SealRules(const MemoryId&)>;

/// Turns closed journals into segments, in order, on a thread of its own. Where this fails the
/// journals keep what they hold, and it is tried again.
///
/// Threading: thread-safe.
/// Source: docs/format.md, section "Writing, locks and crashes".
class Sealer {
 public:
  struct Options {
    /// Before a failed job is tried again.
    Duration retry_after = std::chrono::seconds(10);
  };

  /// What one segment is made of.
  struct Job {
    std::vector<uint64_t> journals;
    uint64_t bytes = 0;                          ///< Of the journals.
    SegmentTypes types;                          ///< That their values came under.
    std::map<MemoryId, DropReasons> dropped_by;  ///< Since the job before.
    SealRulesOf rules;  ///< Empty: all is stored as it lies in the journals.
  };

  Sealer(std::filesystem::path store, const Options& options);
  /// Finishes the job at hand; those behind it stay in their journals.
  ~Sealer();

  void add(Job job);

  /// Waits until fewer than `count` jobs wait, or until one has failed.
  void wait_below(size_t count);

  /// Waits until all jobs are done. A job that failed before is tried again at once.
  /// Errors: that of the first job that fails.
  Status finish();

 private:
  void run(const std::stop_token& stop);

  const std::filesystem::path store_;
  const Options options_;
  Mutex mutex_;
  StoppableCondition changed_;
  std::deque<Job> jobs_ ENGRAM_GUARDED_BY(mutex_);   ///< The first one is at work.
  uint64_t attempts_ ENGRAM_GUARDED_BY(mutex_) = 0;  ///< That have ended.
  /// Calls of finish, which end a wait between tries.
  uint64_t hurries_ ENGRAM_GUARDED_BY(mutex_) = 0;
  Status last_ ENGRAM_GUARDED_BY(mutex_);
  std::jthread thread_;  ///< Last: it uses all the others.
};

/// Publishes journals as one segment and removes them.
/// Errors: kDataLoss, kUnavailable, kResourceExhausted; then the journals are still there.
Status seal_journals(const std::filesystem::path& store, const Sealer::Job& job);

}  // namespace engram::ltm
