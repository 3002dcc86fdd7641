// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "ltm/store/finding.h"
#include "ltm/store/manifest.h"

namespace engram::ltm {

/// A manifest that was made from the files of a store.
struct RebuiltManifest {
  Manifest manifest;
  /// Segments in which not everything can be read; what the manifest says of them is what can.
  std::vector<std::string> damaged;
  uint64_t unreadable = 0;  ///< Segment files of which nothing can be read.
  std::vector<Finding> findings;
};

/// Makes the manifest of a store whose own is broken or gone: from the segment files, in the order
/// of their numbers, the names of the model files, and the types that the segments carry.
/// Errors: kFailedPrecondition where a segment's format is newer; kUnavailable.
Result<RebuiltManifest> rebuild_manifest(const std::filesystem::path& store);

}  // namespace engram::ltm
