// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "ltm/memory/query.h"
#include "ltm/recall/engine_choice.h"
#include "ltm/recall/model.h"
#include "ltm/recording/recorder.h"
#include "server/service/served.h"

namespace engram::server {

/// The store below a working memory: takes what leaves it through the online phase, and answers
/// about both as if they were one.
///
/// Threading: thread-safe; one caller at a time writes, one reads, the others wait.
/// Source: docs/server.md, section "Queries".
class LongTerm {
 public:
  struct Options {
    std::filesystem::path store;
    ltm::Recorder::Options recording;
    /// Decoded snapshots that are kept for the next reader. Unit: plain bytes.
    size_t most_decoded_bytes = size_t{64} << 20;
    bool prefers_latents = false;
    /// Of one answer, decoded: who asks for more is told to ask for less. Unit: plain bytes.
    size_t most_answer_bytes = size_t{512} << 20;
  };

  /// A snapshot that the store will never take, and why.
  struct Refused {
    SharedSnapshot snapshot;
    Status status;
  };

  struct Counters {
    uint64_t recorded = 0;       ///< Snapshots that the online phase took.
    uint64_t refused = 0;        ///< That it will never take.
    uint64_t opened = 0;         ///< Times that the store was read anew.
    uint64_t decoded = 0;        ///< Snapshots.
    uint64_t from_decoded = 0;   ///< That had been decoded before.
    uint64_t decoded_bytes = 0;  ///< That are kept.
    uint64_t lost_frames = 0;    ///< Damaged in an earlier session.
  };

  /// Makes the store where there is none.
  /// Errors: those of ltm::Recorder::open and ltm::StoreReader::open.
  static Result<std::unique_ptr<LongTerm>> open(const Options& options, ltm::ModelLoader loader,
                                                Clock clock = system_now);
  ~LongTerm();

  Status declare(const ltm::MemoryId& segment, const idf::Type& type);

  /// After ok they survive `kill -9` as far as the filters keep them, but for those that are told
  /// as `refused`: their segment's type, which may be younger than they are, has no place for their
  /// values. They hold up no others.
  /// Errors: those of ltm::Recorder::commit where the disk fails; all may be tried again.
  Status record(std::span<const SharedSnapshot> snapshots, std::vector<Refused>& refused);

  /// No snapshot of the entity that is here is later. Nothing where none is. Complexity: O(log n).
  [[nodiscard]] std::optional<Time> known_until(const ltm::MemoryId& entity) const;

  /// Those that a query asks for and that are known here.
  [[nodiscard]] std::vector<ltm::MemoryId> matching(const ltm::Query& query) const;

  /// What is asked of this entity, from what is here and `held`: all that working memory had before
  /// this call, in the order of time.
  struct Answer {
    ServedEntity entity;
    std::vector<Time> future;  ///< Moments that are to be predicted.
  };
  /// `most_bytes`: of what is decoded; less what it took.
  /// Errors: kResourceExhausted where it does not suffice; those of ltm::PastReader.
  Result<Answer> answer(const ltm::Query& query, const ltm::MemoryId& entity,
                        std::span<const SharedSnapshot> held, size_t& most_bytes);

  /// The last `most` snapshots of the entity that are not after `until`, in the order of time.
  Result<std::vector<ltm::SnapshotResult>> newest(const ltm::MemoryId& entity, Time until,
                                                  size_t most);

  /// The newest model of the entity and what it measured of copies, as long as this lives. Who
  /// predicts by them holds lock_models(): decoding uses the same networks.
  Result<std::vector<ltm::Engine>> engines(const ltm::MemoryId& entity);

  using ModelLock = std::unique_lock<std::recursive_mutex>;
  [[nodiscard]] ModelLock lock_models();

  /// Of all sessions: as they were declared last.
  [[nodiscard]] ltm::SegmentTypes types();

  [[nodiscard]] Counters counters() const;

  /// Seals everything. Nothing can be recorded after that.
  Status close();

 private:
  struct State;
  explicit LongTerm(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::server
