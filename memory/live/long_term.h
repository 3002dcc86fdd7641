// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "ltm/recall/recorded_entities.h"
#include "ltm/recording/recorder.h"
#include "ltm/working/held_snapshot.h"

namespace engram::memory {

/// What leaves a working memory, on its way through the online phase to the store below it.
///
/// Threading: thread-safe; one caller at a time writes, the others wait.
/// Source: docs/server.md, section "Queries".
class LongTerm {
 public:
  struct Options {
    std::filesystem::path store;
    ltm::Recorder::Options recording;
    /// Decoded snapshots that are kept for the next reader. Unit: plain bytes.
    size_t max_decoded_bytes = size_t{64} << 20;
    bool prefers_latents = false;
    /// Of one answer, decoded: who asks for more is told to ask for less. Unit: plain bytes.
    size_t max_answer_bytes = size_t{512} << 20;
  };

  /// A snapshot that the store will never take, and why.
  struct Refused {
    ltm::SharedSnapshot snapshot;
    Status status;
  };

  struct Counters {
    uint64_t recorded = 0;     ///< Snapshots that the online phase took.
    uint64_t refused = 0;      ///< That it will never take.
    uint64_t lost_frames = 0;  ///< Damaged in an earlier session.
  };

  /// Makes the store where there is none.
  /// Errors: those of ltm::Recorder::open and ltm::StoreReader::open.
  static Result<std::unique_ptr<LongTerm>> open(const Options& options, Clock clock = system_now);
  ~LongTerm();

  Status declare(const ltm::MemoryId& segment, const idf::Type& type);

  /// The types of all segments. Who checks snapshots with these very types spares it to check them
  /// again.
  [[nodiscard]] ltm::SegmentTypes types() const;

  /// After ok they survive `kill -9` as far as the filters keep them, but for those that are told
  /// as `refused`: their segment's type, which may be younger than they are, has no place for their
  /// values. They hold up no others.
  /// Errors: those of ltm::Recorder::commit where the disk fails; all may be tried again.
  Status record(std::span<const ltm::SharedSnapshot> snapshots, std::vector<Refused>& refused);

  /// What of which entity was recorded, for those who read the store beside this.
  [[nodiscard]] ltm::RecordedEntities& recorded();

  [[nodiscard]] Counters counters() const;

  /// Seals everything. Nothing can be recorded after that.
  Status close();

 private:
  struct State;
  explicit LongTerm(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::memory
