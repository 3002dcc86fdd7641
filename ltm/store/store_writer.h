// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "ltm/memory/segment_types.h"
#include "ltm/store/packed_snapshot.h"
#include "ltm/store/sealer.h"

namespace engram::ltm {

/// When written data is forced to the disk. `kill -9` loses nothing at any level; the levels differ
/// in what a power cut may lose.
enum class Durability {
  kEvery,     ///< Loses nothing acknowledged. Costs one fsync per append.
  kInterval,  ///< Loses at most the data acknowledged during the last Options::sync_interval.
  kNone,      ///< Loses all data that the operating system has not written yet.
};

/// The file of a store that its writer locks.
inline constexpr const char* kWriterLock = "WRITER.lock";

/// The only writer of a store. It appends to the journal; its own threads seal journals into
/// segments and force journals to the disk.
///
/// Threading: one thread. One writer per store, over all processes (file lock).
/// Source: docs/format.md, section "Writing, locks and crashes".
class StoreWriter {
 public:
  struct Options {
    Durability durability = Durability::kInterval;
    Duration sync_interval = std::chrono::milliseconds(200);
    /// Size of a journal at which it is sealed, in bytes. Sealing needs a few times as much memory.
    uint64_t seal_bytes = 64 << 20;
    /// Age at which a journal is sealed, counted by the clock from its first snapshot and checked
    /// at the next append.
    Duration seal_after = std::chrono::minutes(10);
    /// An append waits while more than this many journals of that size wait to be sealed.
    int max_waiting_journals = 4;
    /// Appending fails if the disk has less free space than this, in bytes, so that the journals
    /// can still be sealed.
    uint64_t min_free_bytes = uint64_t{256} << 20;
    /// How an entity's images and numbers are stored when they are sealed. It applies to what this
    /// writer appends; data that others left in their journals is sealed as it is. Encoding images
    /// as groups takes time on the sealer's thread; if it does not keep up, appends wait, see
    /// max_waiting_journals.
    SealRulesOf seal_rules = {};
    /// Told each segment that was sealed; may be empty.
    AfterSeal after_seal = {};

    [[nodiscard]] Status validate() const;
  };

  /// Whether a program has a writer of this store open now.
  [[nodiscard]] static bool is_open(const std::filesystem::path& store);

  /// Opens a store and takes over the journals that a killed writer left.
  /// Errors: kFailedPrecondition if another process writes to it; those of read_manifest.
  static Result<std::unique_ptr<StoreWriter>> open(const std::filesystem::path& store,
                                                   const Options& options,
                                                   Clock clock = system_now);

  /// Does the same as `sync`, but can only log errors. A session that does not end with `seal`
  /// should call `sync` first.
  ~StoreWriter();

  /// Appends to the journal and returns the size of each frame through `frame_bytes`. Times may
  /// come in any order; a snapshot replaces an existing one of the same time.
  /// After ok, all snapshots survive `kill -9`; after an error, none of them is acknowledged.
  /// Errors: kInvalidArgument; kResourceExhausted if the disk is nearly full; kUnavailable if the
  /// disk fails, also if earlier acknowledged data could not be forced to it.
  Status append(const std::vector<PackedSnapshot>& snapshots, std::vector<uint64_t>* frame_bytes);

  /// Records what filters dropped after the last kept snapshot.
  Status append_dropped(const MemoryId& entity, uint64_t dropped, uint64_t dropped_bytes);

  /// Records why filters dropped snapshots. It is stored with the next journal that is sealed.
  void note_dropped_by(const MemoryId& entity, std::string_view filter, uint64_t count);

  /// Declares the type of the values of a core or provider segment, from the next append on.
  /// Earlier values are sealed with the types that they were declared with. After ok the
  /// declaration is durable.
  /// Errors: those of SegmentTypes::declare and of seal.
  Status declare(const MemoryId& segment, const idf::Type& type);

  [[nodiscard]] const SegmentTypes& types() const;

  /// Publishes everything in the journals and waits until it is done.
  /// Errors: those of sealing; the journals then keep everything.
  Status seal();

  /// Forces the unsealed data that this writer appended to the disk, at any level of durability.
  /// After ok no power cut loses it. Each error is returned once; the next call only reports on
  /// data appended since.
  /// Errors: kUnavailable naming the journal, also if forcing at the interval failed since the last
  /// append. A power cut may then lose acknowledged data.
  Status sync();

  /// The latest time of the entity, stored in this session or an earlier one.
  [[nodiscard]] std::optional<Time> last_time(const MemoryId& entity) const;

  /// Acknowledged frames that could not be read when the store was opened.
  [[nodiscard]] uint64_t lost_frames() const;

 private:
  struct State;
  explicit StoreWriter(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
