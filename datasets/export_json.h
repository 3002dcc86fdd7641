// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: it shows the JSON library's type.

#include <nlohmann/json.hpp>
#include <vector>

#include "datasets/export_sink.h"

namespace engram::datasets {

using Json = nlohmann::ordered_json;

/// An image of a value that lies in a file of its own.
struct ImageFile {
  std::string path;  ///< Of the member.
  std::string file;
};

/// {"id", "time_ns", "time", "source", "model"?, "predictor"?, "horizon_ns"?}: what is known about
/// a snapshot beside its instances.
[[nodiscard]] Json snapshot_head(const ltm::MemoryId& entity, const ltm::SnapshotResult& snapshot);

/// {"index", "created_ns", "sent_ns", "arrived_ns", "provider", "confidence", "error"?, "data"};
/// the data in IDF's JSON form, images that are in files as {"$file": name}. What JSON cannot hold
/// (texts that are no UTF-8) is counted, and the data are null.
[[nodiscard]] Json instance_json(const ltm::InstanceResult& instance,
                                 const std::vector<ImageFile>& files, ExportReport& report);

}  // namespace engram::datasets
