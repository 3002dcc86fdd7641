// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <map>
#include <set>
#include <string>
#include <vector>

#include "datasets/mcap/channel_coder.h"
#include "datasets/recordings/recording_format.h"

namespace engram::datasets::mcap {

/// As what one entity is written.
struct PlannedChannel {
  ChannelRecord channel;
  ChannelCoder coder;
};

/// What a file will consist of.
struct ExportPlan {
  std::string profile;
  std::vector<MetadataRecord> metadata;
  std::vector<SchemaRecord> schemas;
  std::map<ltm::MemoryId, PlannedChannel> channels;
  /// Entities whose values were attachments, and become those again.
  std::set<ltm::MemoryId> attachments;
  std::map<std::string, uint64_t, std::less<>> not_held;  ///< As RecordingFormat says it.
};

/// Entities that an import made get their channels back; of others pictures become
/// sensor_msgs/Image or CompressedImage, joints JointState, everything else JSON.
/// Errors: those of exported_entities; kResourceExhausted beyond 65535 entities.
Result<ExportPlan> plan_export(ltm::Recall& recall, const ltm::Query& query,
                               const WritingOptions& options);

}  // namespace engram::datasets::mcap
