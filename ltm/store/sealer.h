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

/// Returns the seal rules of an entity. Called from the sealer's thread.
using SealRulesOf = std::function<SealRules(const MemoryId&)>;

/// Told the name of each segment that was published, relative to the store. Called from the
/// sealer's thread, which it must not hold up.
using AfterSeal = std::function<void(const std::string& segment_file)>;

/// Turns closed journals into segments, in order, on a thread of its own. If a job fails, the
/// journals keep their data and the job is tried again.
///
/// Threading: thread-safe.
/// Source: docs/format.md, section "Writing, locks and crashes".
class Sealer {
 public:
  struct Options {
    /// Time to wait before a failed job is tried again.
    Duration retry_after = std::chrono::seconds(10);
    AfterSeal after_seal{};  ///< May be empty.
  };

  /// The input of one segment.
  struct Job {
    std::vector<uint64_t> journals;
    uint64_t bytes = 0;                          ///< Total size of the journals.
    SegmentTypes types;                          ///< Types that the values were declared with.
    std::map<MemoryId, DropReasons> dropped_by;  ///< Drop reasons since the previous job.
    SealRulesOf rules;  ///< If empty, data is stored as it is in the journals.
  };

  Sealer(std::filesystem::path store, const Options& options);
  /// Finishes the current job. Later jobs stay in their journals.
  ~Sealer();

  void add(Job job);

  /// Waits until fewer than `count` jobs are waiting, or until a job fails.
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
  std::deque<Job> jobs_ ENGRAM_GUARDED_BY(mutex_);   ///< The first one is being worked on.
  uint64_t attempts_ ENGRAM_GUARDED_BY(mutex_) = 0;  ///< Number of attempts that have ended.
  /// Number of calls of finish. Each ends the wait before the next attempt.
  uint64_t hurries_ ENGRAM_GUARDED_BY(mutex_) = 0;
  Status last_ ENGRAM_GUARDED_BY(mutex_);
  std::jthread thread_;  ///< Last: it uses all the others.
};

/// Publishes journals as one segment and removes them. Returns its name, relative to the store;
/// empty if they held nothing to publish. Errors: kDataLoss, kUnavailable, kResourceExhausted; the
/// journals are kept then.
Result<std::string> seal_journals(const std::filesystem::path& store, const Sealer::Job& job);

}  // namespace engram::ltm
