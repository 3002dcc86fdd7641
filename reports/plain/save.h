// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ltm/recall/recall.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// {"psnr_db", "rmse"}, without those that are unknown.
[[nodiscard]] Json error_json(const ltm::MeasuredError& error);
/// The same for a bound, with its probability.
[[nodiscard]] Json bound_json(const ltm::MeasuredError& bound,
                              double probability = ltm::kBoundProbability);

/// A snapshot of an answer as JSON: its source, its errors, and per instance the data in IDF's JSON
/// form. With `image_files`, images are replaced by {"$file": name}, in the order of their members.
Result<Json> snapshot_json(const ltm::MemoryId& entity, const ltm::SnapshotResult& recalled,
                           const std::vector<std::vector<std::string>>* image_files = nullptr);

/// Writes a snapshot below `directory`: <entity>/<time>.json, and each image beside it as PNG.
/// Returns the files.
/// Errors: kUnavailable, kResourceExhausted.
Result<std::vector<std::filesystem::path>> save_snapshot(const ltm::MemoryId& entity,
                                                         const ltm::SnapshotResult& recalled,
                                                         const std::filesystem::path& directory);

}  // namespace engram::reports
