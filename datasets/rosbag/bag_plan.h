// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <map>

#include "datasets/recordings/exported_streams.h"
#include "datasets/rosbag/connection_coder.h"

namespace engram::datasets::rosbag {

/// The connection that one entity is written as.
struct PlannedConnection {
  Connection connection;
  ConnectionCoder coder;
};

/// The contents of a bag that is to be written.
struct ExportPlan {
  std::map<ltm::MemoryId, PlannedConnection> connections;
  NotHeld not_held;  ///< As RecordingFormat::not_held.
};

/// Plans an export. Entities that were imported from a bag get their connections back. All others
/// get one of own_connection(), with a unique topic that ROS accepts.
/// Errors: those of visit_exported.
Result<ExportPlan> plan_export(ltm::Recall& recall, const ltm::Query& query,
                               const WritingOptions& options);

}  // namespace engram::datasets::rosbag
