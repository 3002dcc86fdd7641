// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "ltm/memory/commit.h"
#include "ltm/memory/segment_types.h"

namespace engram::memory {

/// The knowledge that a robot has before it has seen anything: objects, places, how grasps are
/// done.
struct PriorKnowledge {
  /// The types of its core and provider segments; all values have these types.
  ltm::SegmentTypes types;
  /// The commits by the name of the memory, each in the order of its entities.
  std::map<std::string, ltm::Commit> commits;
  /// What could not be loaded, as "FILE:LINE: ..."; always empty without PriorOptions::goes_on.
  std::vector<std::string> problems;
};

struct PriorOptions {
  /// Loads what can be loaded and reports the rest as problems. False: loads everything or nothing.
  bool goes_on = false;
  size_t max_files = 10'000;
  uint64_t max_file_bytes = uint64_t{64} << 20;
  /// The bound of a JSON file, which takes many times its size while it is read. The bound of YAML
  /// is ConfigValue::kMaxBytes.
  uint64_t max_json_bytes = uint64_t{16} << 20;
  /// The bound of all plain values, with images decoded. They are in RAM at once.
  uint64_t max_bytes = uint64_t{1} << 30;
  int64_t max_pixels = 64'000'000;  ///< The bound of one image, checked before it is decoded.
};

/// Reads a directory of IDF values, images and other files, one for each entity.
///
///     DIR/prior.yaml                                 "time:" of all snapshots, optional
///     DIR/Objects/Things.type.xml                    the type of a core segment
///     DIR/Objects/Things/kitchen.type.xml            the type of a provider segment
///     DIR/Objects/Things/kitchen/blue-cup.yaml       entity Objects/Things/kitchen/blue-cup
///
/// Names that begin with a dot are skipped; symbolic links are followed within the directory. The
/// provider of all instances is "prior". Their time is that of prior.yaml, otherwise the last
/// change of the file.
/// Errors: kNotFound where there is no directory; otherwise kInvalidArgument with all problems, one
/// per line.
/// Source: docs/prior.md.
Result<PriorKnowledge> load_prior(const std::filesystem::path& directory,
                                  const PriorOptions& options = {});

}  // namespace engram::memory
