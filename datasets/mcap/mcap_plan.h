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

/// The channel that one entity is written as.
struct PlannedChannel {
  ChannelRecord channel;
  ChannelCoder coder;
};

/// The contents of a file that is to be written.
struct ExportPlan {
  std::string profile;
  std::vector<MetadataRecord> metadata;
  std::vector<SchemaRecord> schemas;
  std::map<ltm::MemoryId, PlannedChannel> channels;
  /// Entities that were imported from attachments, and become attachments again.
  std::set<ltm::MemoryId> attachments;
  std::map<std::string, uint64_t, std::less<>> not_held;  ///< As RecordingFormat::not_held.
};

/// Plans an export. Imported entities get their channels back. Of all others, pictures become
/// sensor_msgs/Image or CompressedImage, joints JointState, everything else JSON.
/// Errors: those of exported_entities; kResourceExhausted for more than 65535 entities.
Result<ExportPlan> plan_export(ltm::Recall& recall, const ltm::Query& query,
                               const WritingOptions& options);

}  // namespace engram::datasets::mcap
