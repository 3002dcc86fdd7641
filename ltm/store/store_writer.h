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

/// When what was written is forced to the disk. `kill -9` loses nothing at any level; these say
/// what a power cut may cost.
enum class Durability {
  kEvery,     ///< Nothing acknowledged. One fsync per append.
  kInterval,  ///< At most what was acknowledged in the last Options::sync_interval.
  kNone,      ///< What the operating system had not written yet.
};

/// The only writer of a store: appends to the journal; threads of its own seal journals into
/// segments and force them to the disk.
///
/// Threading: one thread. One per store, over all processes (file lock).
/// Source: docs/format.md, section "Writing, locks and crashes".
class StoreWriter {
 public:
  struct Options {
    Durability durability = Durability::kInterval;
    Duration sync_interval = std::chrono::milliseconds(200);
    /// A journal of this size is sealed. Costs a few times as much memory while sealing.
    uint64_t seal_bytes = 64 << 20;
    /// So is one whose first snapshot came this long ago, by the clock, at the next append.
    Duration seal_after = std::chrono::minutes(10);
    /// An append waits where more than this many journals of that size wait to be sealed.
    int max_waiting_journals = 4;
    /// Recording stops with an error where the disk has less free space: what is there can still
    /// be sealed then.
    uint64_t min_free_bytes = uint64_t{256} << 20;
    /// What becomes of an entity's images and numbers when they are sealed. Counts for what this
    /// writer appends: what others left in their journals is sealed as it lies there. Encoding
    /// images as groups costs time of the sealer's thread; appends wait where that does not keep
    /// up, see max_waiting_journals.
    SealRulesOf seal_rules = {};

    [[nodiscard]] Status validate() const;
  };

  /// Opens a store and takes over what a killed writer left in its journals.
  /// Errors: kFailedPrecondition where another process writes; those of read_manifest.
  static Result<std::unique_ptr<StoreWriter>> open(const std::filesystem::path& store,
                                                   const Options& options,
                                                   Clock clock = system_now);

  /// Does what `sync` does, but can only log what fails: whoever ends a session otherwise than by
  /// `seal` calls `sync` before.
  ~StoreWriter();

  /// Appends to the journal; the bytes of each frame are returned through `frame_bytes`. Times may
  /// come in any order; a snapshot of a time that is there takes its place.
  /// After ok, all of them survive `kill -9`; after an error, none of them was acknowledged.
  /// Errors: kInvalidArgument; kResourceExhausted where the disk is nearly full; kUnavailable where
  /// it fails, also where what was acknowledged before could not be forced to it.
  Status append(const std::vector<PackedSnapshot>& snapshots, std::vector<uint64_t>* frame_bytes);

  /// Notes what filters dropped after the last snapshot that was kept.
  Status append_dropped(const MemoryId& entity, uint64_t dropped, uint64_t dropped_bytes);

  /// Notes why filters dropped snapshots; stored with the next journal that is sealed.
  void note_dropped_by(const MemoryId& entity, std::string_view filter, uint64_t count);

  /// Says what the values of a core or provider segment are, from the next append on. What was
  /// appended before is sealed with the types that it came under. After ok this is durable.
  /// Errors: those of SegmentTypes::declare and of seal.
  Status declare(const MemoryId& segment, const idf::Type& type);

  [[nodiscard]] const SegmentTypes& types() const;

  /// Publishes everything in the journals and waits until it is done.
  /// Errors: those of the sealing; the journals keep everything then.
  Status seal();

  /// Forces what this writer appended and is not sealed to the disk, at any level of durability:
  /// after ok no power cut costs it. An error is told once: the next call is about what was
  /// appended since.
  /// Errors: kUnavailable naming the journal, also where the regular forcing failed since the last
  /// append; what was acknowledged may not survive a power cut then.
  Status sync();

  /// The latest time of the entity, stored in this session or before.
  [[nodiscard]] std::optional<Time> last_time(const MemoryId& entity) const;

  /// Acknowledged frames that could not be read when the store was opened.
  [[nodiscard]] uint64_t lost_frames() const;

 private:
  struct State;
  explicit StoreWriter(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
