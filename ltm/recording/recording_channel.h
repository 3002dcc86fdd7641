// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "ltm/filter/filter_chain.h"
#include "ltm/recording/recorder.h"
#include "ltm/store/manifest.h"

namespace engram::ltm {

/// The recording state of one entity.
struct RecordingChannel {
  MemoryId entity;
  FilterChain chain;
  Packer packer;
  RecordingCounters* counters;  ///< Owned by the recorder.
  uint64_t dropped = 0;         ///< Since the last snapshot that was kept, or the last note.
  uint64_t dropped_bytes = 0;
  DropReasons noted_by;  ///< Dropped snapshots that the store was told of, by filter.
  uint64_t pending = 0;  ///< Snapshots that left the filters but are not stored: the disk failed.
  uint64_t pending_bytes = 0;

  bool is_event_source = false;              ///< True if a rule's events may come from it.
  std::optional<Snapshot> last_offered;      ///< Set for event sources only.
  std::optional<idf::Type> last_type;        ///< Of its values, if it is known.
  std::vector<RecordingChannel*> listeners;  ///< Channels whose filters listen to this entity.

  /// Updates the counters from the filters.
  void count() const;
};

/// The channels of a session. A channel is made at its entity's first snapshot.
///
/// Threading: one thread.
class RecordingChannels {
 public:
  /// `options` must be valid and outlive this.
  explicit RecordingChannels(const Recorder::Options& options);

  /// The entity's channel; valid as long as this.
  RecordingChannel& of(const MemoryId& entity);

  /// Null if the entity has none yet.
  [[nodiscard]] RecordingChannel* find(const MemoryId& entity);

  [[nodiscard]] std::map<MemoryId, RecordingChannel>& all() { return channels_; }
  [[nodiscard]] const std::map<MemoryId, RecordingCounters>& counters() const;
  /// Whether any rule keeps what others link to.
  [[nodiscard]] bool keeps_linked() const { return keeps_linked_; }

 private:
  void connect(RecordingChannel& made);

  const Recorder::Options& options_;
  std::vector<Packer> packers_;  ///< One per rule, then one for entities without a rule.
  std::vector<EntityPattern> event_sources_;
  bool keeps_linked_ = false;
  std::map<MemoryId, RecordingChannel> channels_;
  std::map<MemoryId, RecordingCounters> counters_;
};

}  // namespace engram::ltm
