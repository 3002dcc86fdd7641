// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "ltm/recall/recorded_entities.h"
#include "ltm/recording/recorder.h"
#include "ltm/working/held_snapshot.h"

namespace engram::memory {

/// Records what leaves a working memory: through the online phase to the store. What comes was
/// redacted (MemoryService::commit), and is again only if it is cast to a newer type.
///
/// Threading: thread-safe; one caller at a time writes, the others wait.
/// Source: docs/server.md, section "Queries".
class LongTerm {
 public:
  struct Options {
    std::filesystem::path store;
    ltm::Recorder::Options recording;
    /// The bound of decoded snapshots that are cached. Unit: plain bytes.
    size_t max_decoded_bytes = size_t{64} << 20;
    bool prefers_latents = false;
    /// The bound of one answer when decoded; larger answers are refused. Unit: plain bytes.
    size_t max_answer_bytes = size_t{512} << 20;
  };

  /// A snapshot that the store will never take, and the reason.
  struct Refused {
    ltm::SharedSnapshot snapshot;
    Status status;
  };

  struct Counters {
    uint64_t recorded = 0;     ///< Snapshots that the online phase took.
    uint64_t refused = 0;      ///< Snapshots that it will never take.
    uint64_t lost_frames = 0;  ///< Frames that were damaged in an earlier session.
  };

  /// Creates the store if there is none.
  /// Errors: those of ltm::Recorder::open and ltm::StoreReader::open.
  /// `redactor` is the one of working memory; null: nothing is redacted.
  static Result<std::unique_ptr<LongTerm>> open(const Options& options, Clock clock = system_now,
                                                std::shared_ptr<ltm::Redactor> redactor = nullptr);
  ~LongTerm();

  Status declare(const ltm::MemoryId& segment, const idf::Type& type);

  /// The types of all segments. Snapshots that were checked against these very types are not
  /// checked again.
  [[nodiscard]] ltm::SegmentTypes types() const;

  /// After ok the snapshots survive `kill -9` as far as the filters keep them, except those in
  /// `refused`: the type of their segment, which may be newer than they are, has no place for their
  /// values. Refused snapshots do not hold up others.
  /// Errors: those of ltm::Recorder::commit where the disk fails; all snapshots may be tried again.
  Status record(std::span<const ltm::SharedSnapshot> snapshots, std::vector<Refused>& refused);

  /// See ltm::Recorder::waiting_times, forget and seal.
  [[nodiscard]] std::map<ltm::MemoryId, TimeSet> waiting_times() const;
  void forget(const std::map<ltm::MemoryId, TimeSet>& gone);
  Status seal();

  /// Looks up in the store what it still has of these entities, and corrects recorded().
  /// Errors: those of ltm::StoreReader.
  Status note_forgotten(std::span<const ltm::MemoryId> entities);

  /// What was recorded of each entity, for those who read the store at the same time.
  [[nodiscard]] ltm::RecordedEntities& recorded();

  [[nodiscard]] Counters counters() const;

  /// Seals everything. Nothing can be recorded afterwards.
  Status close();

 private:
  struct State;
  explicit LongTerm(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::memory
