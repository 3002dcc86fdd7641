// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: commits to a memory that may be away.

#include <vector>

#include "datasets/kitchen/drivers.h"

namespace engram::datasets::kitchen {

/// Commits what a driver senses, says when the memory is away and when it is back, and repeats then
/// what a memory needs first: types, and what is known before.
///
/// Threading: one thread. Options must outlive it.
class KeptCommits {
 public:
  /// `prior` is committed first. A body that `waits` is stepped: each commit is repeated until it
  /// is kept.
  KeptCommits(const DriverOptions& options, ltm::Commit prior, bool waits)
      : options_(options), prior_(std::move(prior)), waits_(waits) {}

  /// Returns whether the memory took it.
  /// Errors: those of the memory but kUnavailable; kCancelled if `stop` is requested.
  Result<bool> commit(const ltm::Commit& commit, const std::stop_token& stop);

  [[nodiscard]] int times_away() const { return times_away_; }

 private:
  Status prepare_and_commit(const ltm::Commit& commit);

  const DriverOptions& options_;
  ltm::Commit prior_;
  bool waits_;
  bool is_prepared_ = false;
  bool is_away_ = false;
  int times_away_ = 0;
  uint64_t lost_ = 0;  ///< Snapshots since the memory was away.
};

/// Adds a snapshot to a commit.
void add_snapshot(ltm::Commit& commit, ltm::MemoryId entity, Time time,
                  std::vector<idf::Data> values, std::string_view provider);

}  // namespace engram::datasets::kitchen
