// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ltm/core/time_set.h"
#include "ltm/filter/filter_chain.h"
#include "ltm/memory/checked_snapshot.h"
#include "ltm/memory/commit.h"
#include "ltm/recording/entity_rule.h"
#include "ltm/redaction/redactor.h"
#include "ltm/store/store_writer.h"

namespace engram::ltm {

/// Counts what happened to the snapshots of one entity during recording.
///
/// Between any two commits: offered = kept + all dropped_by + held + failed.
struct RecordingCounters {
  std::string rule;  ///< Name of the rule that matched the entity; empty if none did.
  uint64_t offered = 0;
  uint64_t offered_bytes = 0;  ///< Plain bytes.
  uint64_t kept = 0;
  uint64_t kept_bytes = 0;                                  ///< Plain bytes.
  uint64_t stored_bytes = 0;                                ///< Of the journal frames.
  std::map<std::string, uint64_t, std::less<>> dropped_by;  ///< Per filter name.
  std::vector<FilterCounters> filters;  ///< In the order of the chain, with reasons.
  /// Snapshots in memory that are not decided on; they are lost if the process ends.
  HeldSnapshots held;
  /// Offered snapshots that came after a newer one; no filter saw them.
  uint64_t late = 0;
  /// Snapshots that are not stored because their commit failed; the caller got the error.
  uint64_t failed = 0;
  /// Instances that were cast to their segment's type and lost members or digits.
  uint64_t reinterpreted = 0;
  std::string last_reinterpretation;  ///< What the last such cast lost.
  /// Images that were redacted, and the boxes that were found in them.
  uint64_t redacted_images = 0;
  uint64_t redacted_boxes = 0;
  /// Snapshots that redaction dropped, which `dropped_by` counts as "redact"; those of them that no
  /// detector answered for; and those with an image in a form in which no detector looks. No filter
  /// saw them.
  uint64_t redact_dropped = 0;
  uint64_t redact_unanswered = 0;
  uint64_t redact_unreadable = 0;
};

/// How to treat a snapshot whose time is not after the entity's last one.
enum class LateSnapshots : uint8_t {
  kKeep,    ///< It is stored and bypasses all filters.
  kRefuse,  ///< Its commit is refused.
};

/// The online phase: redacts incoming snapshots where a rule says so, filters them, encodes those
/// that are kept, and stores them.
///
/// Threading: one thread; it has its own threads for encoding.
/// Source: docs/recording.md.
class Recorder {
 public:
  static constexpr int kMaxThreads = 64;

  struct Options {
    /// Max rate at which entities without a matching rule are kept. Empty: no limit. Unit:
    /// snapshots per second.
    std::optional<double> max_rate_hz;
    /// Packing of entities without a matching rule.
    PackOptions pack;
    /// If its `seal_rules` are empty, they are made from the packing rules.
    StoreWriter::Options store;
    /// The first rule that matches an entity is used.
    std::vector<EntityRule> rules;
    LateSnapshots late = LateSnapshots::kKeep;
    /// How far ahead of the clock the times of snapshots may lie, unless their rule says it.
    Duration max_ahead = AheadLimits().all;
    /// Threads that encode the snapshots of one commit, including the caller's. 1 to kMaxThreads.
    int threads = 2;
    /// Interval at which counts of dropped snapshots are stored if no snapshot is kept. `kill -9`
    /// loses the counts of one interval. Each note costs about 200 bytes per entity that dropped
    /// any.
    Duration drop_note_interval = std::chrono::seconds(5);
    /// Called with the ID of each snapshot that a commit stores and an earlier one offered: a
    /// filter held it until then, or the disk failed. Its entity may be none of the commit's. May
    /// be empty.
    std::function<void(const MemoryId& snapshot)> on_released;

    [[nodiscard]] Status validate() const;
  };

  /// Opens `store` for writing and makes it if it does not exist.
  /// Errors: kInvalidArgument; kFailedPrecondition if another process writes to it; those of
  /// StoreWriter::open and of Redactor::create.
  static Result<Recorder> open(const std::filesystem::path& store, const Options& options,
                               Clock clock = system_now);

  /// The same with a redactor that others use, too, instead of one that is made of the rules; null:
  /// nothing is redacted.
  static Result<Recorder> open(const std::filesystem::path& store, const Options& options,
                               Clock clock, std::shared_ptr<Redactor> redactor);

  Recorder(Recorder&&) noexcept;
  ~Recorder();

  /// Declares the type of the values in a core segment (two names) or provider segment (three
  /// names). Values of other types are cast to it if possible, else their commit is refused. The
  /// type is stored with the segment and holds in later sessions too.
  /// Errors: kInvalidArgument if a provider's type does not extend the core type; those of
  /// StoreWriter::declare.
  Status declare(const MemoryId& segment, const idf::Type& type);

  /// Filters and stores the snapshots of a commit. After this returns ok, every snapshot that
  /// counts as kept survives `kill -9`. A snapshot that a filter holds does not, until a later
  /// commit or close() releases it.
  /// Errors: those of Commit::check; kInvalidArgument if a late snapshot is refused, if a time lies
  /// too far ahead of the clock, or if values
  /// are not of their segment's type (it names every path); kResourceExhausted or kUnavailable if
  /// the disk fails: then nothing of the commit was acknowledged, and it may be tried again.
  Status commit(const Commit& commit);

  /// The same for snapshots that were checked before, such as those of working memory: their times
  /// are not checked again, and their values only if their segment's type has changed since. They
  /// were redacted when they were checked, because working memory must not have them unredacted
  /// either; those that are cast now are redacted again, since the cast may make images.
  Status commit_checked(std::span<const CheckedSnapshot* const> updates);

  /// The types of all segments, declared in this session or earlier ones.
  [[nodiscard]] const SegmentTypes& types() const;

  /// Drops and counts a snapshot before it is made, if the entity's filters would drop it for its
  /// time alone. Use it for values that are expensive to make. If it returns false, nothing
  /// happened: make the snapshot and commit it. `raw_bytes` is what Snapshot::raw_bytes would be.
  bool drop_unmade(const MemoryId& entity, Time time, uint64_t raw_bytes);

  /// The times of what waits in memory, by entity: what filters hold, and what they kept when the
  /// disk failed.
  [[nodiscard]] std::map<MemoryId, TimeSet> waiting_times() const;

  /// Drops what waits in memory of these times, and lets filters of these entities compare with
  /// nothing that they saw. What is in the store stays. Counts it as dropped by the filter that
  /// held it, or as failed.
  void forget(const std::map<MemoryId, TimeSet>& gone);

  /// Publishes what is in the journals, see StoreWriter::seal.
  Status seal();

  /// Releases what filters hold, seals everything and closes the store. Without it, what was kept
  /// stays in the journal.
  /// Errors: those of commit and of StoreWriter::seal. Then acknowledged data stays in the journal,
  /// which is forced to the disk; if that fails too (StoreWriter::sync), the message says so.
  Status close();

  /// Time of the entity's last snapshot, stored in this session or an earlier one.
  [[nodiscard]] std::optional<Time> last_time(const MemoryId& entity) const;

  /// Number of places in the journal where acknowledged data of an earlier session is damaged.
  [[nodiscard]] uint64_t lost_frames() const;

  /// Counters per entity of this session, updated by this call. Valid as long as the recorder.
  [[nodiscard]] const std::map<MemoryId, RecordingCounters>& counters() const;

 private:
  struct State;
  explicit Recorder(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
