// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ltm/filter/filter_chain.h"
#include "ltm/memory/checked_snapshot.h"
#include "ltm/memory/commit.h"
#include "ltm/recording/entity_rule.h"
#include "ltm/store/store_writer.h"

namespace engram::ltm {

/// What happened to the snapshots of one entity on their way in.
///
/// offered = kept + all dropped_by + held + failed, between any two commits.
struct RecordingCounters {
  std::string rule;  ///< Name of the rule that the entity got; empty where none matched.
  uint64_t offered = 0;
  uint64_t offered_bytes = 0;  ///< Plain bytes.
  uint64_t kept = 0;
  uint64_t kept_bytes = 0;                                  ///< Plain bytes.
  uint64_t stored_bytes = 0;                                ///< Of the journal frames.
  std::map<std::string, uint64_t, std::less<>> dropped_by;  ///< Per filter name.
  std::vector<FilterCounters> filters;  ///< In the order of the chain, with reasons.
  HeldSnapshots held;                   ///< In memory, not decided on: lost where the process ends.
  uint64_t late = 0;    ///< Of those offered: came after a newer one, and no filter saw them.
  uint64_t failed = 0;  ///< Their commit failed: not stored, and the caller knows.
  /// Instances that were cast to their segment's type, which cost members or digits.
  uint64_t reinterpreted = 0;
  std::string last_reinterpretation;  ///< What it cost, the last time.
};

/// What becomes of a snapshot whose time does not come after the entity's last one.
enum class LateSnapshots : uint8_t {
  kKeep,    ///< It is stored, past all filters.
  kRefuse,  ///< Its commit is refused.
};

/// The online phase: filters what comes in, encodes what is kept, stores it.
///
/// Threading: one thread; it has threads of its own for encoding.
/// Source: docs/recording.md.
class Recorder {
 public:
  static constexpr int kMaxThreads = 64;

  struct Options {
    /// For entities that no rule matches: most snapshots per second that are kept. Nothing: all.
    std::optional<double> max_rate_hz;
    /// For the same entities.
    PackOptions pack;
    /// Its `seal_rules` are made of the rules for packing, where they are empty.
    StoreWriter::Options store;
    /// The first one that matches an entity counts.
    std::vector<EntityRule> rules;
    LateSnapshots late = LateSnapshots::kKeep;
    /// That encode the snapshots of one commit, the caller's included. 1 to kMaxThreads.
    int threads = 2;
    /// How often counts of dropped snapshots reach the store where none is kept: what `kill -9`
    /// may cost of them. Each note costs about 200 bytes per entity that dropped any.
    Duration drop_note_interval = std::chrono::seconds(5);

    [[nodiscard]] Status validate() const;
  };

  /// Opens `store` for writing and makes it where it does not exist.
  /// Errors: kInvalidArgument, kFailedPrecondition where another process writes to it, and those
  /// of StoreWriter::open.
  static Result<Recorder> open(const std::filesystem::path& store, const Options& options,
                               Clock clock = system_now);

  Recorder(Recorder&&) noexcept;
  ~Recorder();

  /// Says what the values of a core segment (two names) or provider segment (three) are: commits
  /// are reinterpreted as that type where possible, and refused where not. The type is stored with
  /// the segment and holds in later sessions too.
  /// Errors: kInvalidArgument where a provider's type does not extend the core type; those of
  /// StoreWriter::declare.
  Status declare(const MemoryId& segment, const idf::Type& type);

  /// After this returns ok, every snapshot of the commit that counts as kept survives `kill -9`.
  /// What a filter holds does not, until a later commit or close lets it go.
  /// Errors: those of Commit::check; kInvalidArgument where a late snapshot is refused, or naming
  /// every path where a value is not of its segment's type; kResourceExhausted, kUnavailable where
  /// the disk fails: then nothing of the commit was acknowledged, and it may be tried again.
  Status commit(const Commit& commit);

  /// The same of snapshots that were checked on their way here, as working memory's were: their
  /// values are not looked at again, but where their segment's type is another by now.
  Status commit_checked(std::span<const CheckedSnapshot* const> updates);

  /// The types of all segments, as they were declared here or in sessions before.
  [[nodiscard]] const SegmentTypes& types() const;

  /// Drops a snapshot that is not made yet, where the entity's filters would by its time alone, and
  /// counts it as any other. For values that cost much to make. False: nothing happened; make it
  /// and commit it. `raw_bytes`: what Snapshot::raw_bytes would be.
  bool drop_unmade(const MemoryId& entity, Time time, uint64_t raw_bytes);

  /// Lets go of what filters hold, seals everything and closes the store. Without it the journal
  /// keeps what was kept.
  /// Errors: those of commit and of StoreWriter::seal: the journal keeps what was acknowledged, and
  /// is forced to the disk; where that fails too (StoreWriter::sync), the message says so.
  Status close();

  /// Time of the entity's last snapshot, stored in this session or before.
  [[nodiscard]] std::optional<Time> last_time(const MemoryId& entity) const;

  /// Places in the journal where acknowledged data of an earlier session was found damaged.
  [[nodiscard]] uint64_t lost_frames() const;

  /// Per entity of this session; current as of this call, valid as long as the recorder.
  [[nodiscard]] const std::map<MemoryId, RecordingCounters>& counters() const;

 private:
  struct State;
  explicit Recorder(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
