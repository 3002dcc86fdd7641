// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "ltm/filter/filter_chain.h"
#include "ltm/recording/recorder.h"
#include "ltm/store/manifest.h"

namespace engram::ltm {

/// One entity on its way in.
struct RecordingChannel {
  MemoryId entity;
  FilterChain chain;
  Packer packer;
  RecordingCounters* counters;  ///< Of the recorder.
  uint64_t dropped = 0;         ///< Since the last snapshot that was kept, or the last note.
  uint64_t dropped_bytes = 0;
  DropReasons noted_by;  ///< What the store was told of them, by filter.
  uint64_t pending = 0;  ///< Left the filters, but the disk failed.
  uint64_t pending_bytes = 0;

  bool is_event_source = false;              ///< Some rule's events may come from it.
  std::optional<Snapshot> last_offered;      ///< Of event sources only.
  std::vector<RecordingChannel*> listeners;  ///< Channels whose filters want to know of it.

  /// Brings the counters up to date with the filters.
  void count() const;
};

/// The channels of a session, made as entities come.
///
/// Threading: one thread.
class RecordingChannels {
 public:
  /// `options` are valid and outlive this.
  explicit RecordingChannels(const Recorder::Options& options);

  /// The entity's channel; valid as long as this.
  RecordingChannel& of(const MemoryId& entity);

  [[nodiscard]] std::map<MemoryId, RecordingChannel>& all() { return channels_; }
  [[nodiscard]] const std::map<MemoryId, RecordingCounters>& counters() const;

 private:
  void connect(RecordingChannel& made);

  const Recorder::Options& options_;
  std::vector<Packer> packers_;  ///< Per rule, then that of entities without one.
  std::vector<EntityPattern> event_sources_;
  std::map<MemoryId, RecordingChannel> channels_;
  std::map<MemoryId, RecordingCounters> counters_;
};

}  // namespace engram::ltm
