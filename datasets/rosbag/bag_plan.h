// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <map>

#include "datasets/recordings/exported_streams.h"
#include "datasets/rosbag/connection_coder.h"

namespace engram::datasets::rosbag {

/// As what one entity is written.
struct PlannedConnection {
  Connection connection;
  ConnectionCoder coder;
};

/// What a bag will consist of.
struct ExportPlan {
  std::map<ltm::MemoryId, PlannedConnection> connections;
  NotHeld not_held;  ///< As RecordingFormat says it.
};

/// Entities that an import of a bag made get their connections back; all others get one of
/// own_connection(), with a topic that ROS accepts and no other has.
/// Errors: those of visit_exported.
Result<ExportPlan> plan_export(ltm::Recall& recall, const ltm::Query& query,
                               const WritingOptions& options);

}  // namespace engram::datasets::rosbag
