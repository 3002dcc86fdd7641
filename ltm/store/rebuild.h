// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "ltm/store/finding.h"
#include "ltm/store/manifest.h"

namespace engram::ltm {

/// A manifest that was rebuilt from the files of a store.
struct RebuiltManifest {
  Manifest manifest;
  /// Segments that are partly unreadable. The manifest describes only their readable content.
  std::vector<std::string> damaged;
  uint64_t unreadable = 0;  ///< Number of segment files that are completely unreadable.
  std::vector<Finding> findings;
};

/// Rebuilds the manifest of a store whose own is damaged or missing. It uses the segment files in
/// the order of their numbers, the names of the model files, and the types stored in the segments.
/// Errors: kFailedPrecondition if a segment's format is newer than this program's; kUnavailable.
Result<RebuiltManifest> rebuild_manifest(const std::filesystem::path& store);

}  // namespace engram::ltm
