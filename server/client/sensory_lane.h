// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>

#include "ltm/core/mutex.h"
#include "ltm/memory/commit.h"
#include "server/client/loan.h"
#include "server/client/shared_lane.h"
#include "server/sharing/sensory_writer.h"

namespace engram::server {

/// The rings into which a client writes snapshots of sensory segments, in memory that it shares
/// with its server. Nothing is sent to the server while nobody attends to them.
///
/// Threading: thread-safe.
/// Source: docs/sensory.md.
class SensoryLane {
 public:
  /// Sends a request on the stream of commits of the shared lane, and waits for its reply.
  using Ask = std::function<Result<v1::CommitReply>(v1::CommitRequest request)>;

  SensoryLane(std::shared_ptr<SharedLane> shared, Ask ask)
      : shared_(std::move(shared)), ask_(std::move(ask)) {}

  /// What the server is to be told of a commit in a ring.
  struct Written {
    v1::SensoryEntry entry;
    bool is_attended = false;  ///< False: nobody needs to be told.
  };

  /// Writes a commit whose entities all are sensory. Nothing if it must go another way: it has too
  /// many entities, or one of them twice, or several segments, or too much besides its data, or
  /// there is no room for a ring, or another thread just opens one.
  /// Errors: kInvalidArgument if a value nests too deep.
  std::optional<Result<Written>> write(const ltm::Commit& commit);

  /// Lends room for the arrays of a commit of these entities, which `named` names. Nothing where
  /// write() would send the commit another way, or where there is no room.
  std::optional<Loan> lend(std::span<const ArrayToLend> arrays, const ltm::Commit& named);

 private:
  struct Lent;
  struct Ring;
  struct Place {
    std::shared_ptr<Ring> ring;
    uint64_t bit = 0;
  };
  /// Where a commit goes.
  struct Target {
    std::shared_ptr<Ring> ring;
    uint64_t entities = 0;
  };

  std::optional<Target> find(const ltm::Commit& commit) ENGRAM_EXCLUDES(mutex_);
  [[nodiscard]] std::optional<Target> find_known(const ltm::Commit& commit, bool& is_complete)
      ENGRAM_REQUIRES(mutex_);
  Status open(const ltm::Commit& commit) ENGRAM_EXCLUDES(mutex_);
  Result<std::shared_ptr<Ring>> map(const v1::SensoryRing& told) ENGRAM_EXCLUDES(mutex_);
  void forget(const std::shared_ptr<Ring>& ring) ENGRAM_EXCLUDES(mutex_);
  /// Asks the server to take what it needs of a ring.
  void sync(uint64_t ring, uint64_t written) const;

  const std::shared_ptr<SharedLane> shared_;
  const Ask ask_;
  Mutex mutex_;
  std::unordered_map<ltm::MemoryId, Place> places_ ENGRAM_GUARDED_BY(mutex_);
  /// The server said that there is no ring: it is not asked again before.
  SteadyTime open_again_ ENGRAM_GUARDED_BY(mutex_){};
  /// A thread asks the server for a ring. Others send their commits meanwhile: a wait for it might
  /// keep from work the threads that it needs.
  bool is_opening_ ENGRAM_GUARDED_BY(mutex_) = false;
};

}  // namespace engram::server
