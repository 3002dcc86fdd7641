// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room, because it exposes the type of the JSON library.

#include <nlohmann/json.hpp>
#include <vector>

#include "datasets/export_sink.h"

namespace engram::datasets {

using Json = nlohmann::ordered_json;

/// An image of a value that is stored in a file of its own.
struct ImageFile {
  std::string path;  ///< The path of the member.
  std::string file;
};

/// Describes a snapshot without its instances: {"id", "time_ns", "time", "source", "model"?,
/// "predictor"?, "horizon_ns"?}.
[[nodiscard]] Json snapshot_head(const ltm::MemoryId& entity, const ltm::SnapshotResult& snapshot);

/// Describes an instance: {"index", "created_ns", "sent_ns", "arrived_ns", "provider",
/// "confidence", "error"?, "data"}. The data are in IDF's JSON form; images in files are
/// {"$file": name}. What JSON cannot hold (text that is not UTF-8) is counted, and the data are
/// null.
[[nodiscard]] Json instance_json(const ltm::InstanceResult& instance,
                                 const std::vector<ImageFile>& files, ExportReport& report);

}  // namespace engram::datasets
