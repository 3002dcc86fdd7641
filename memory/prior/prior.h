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

/// What a robot knows before it has seen anything: objects, places, how grasps are done.
struct PriorKnowledge {
  /// Those of its core and provider segments; all values are of them.
  ltm::SegmentTypes types;
  /// By the name of the memory, each in the order of its entities.
  std::map<std::string, ltm::Commit> commits;
  /// What could not be loaded, as "FILE:LINE: ..."; empty unless it was asked to go on.
  std::vector<std::string> problems;
};

struct PriorOptions {
  /// Loads what can be loaded where something cannot. Else all of it or nothing.
  bool goes_on = false;
  size_t max_files = 10'000;
  uint64_t max_file_bytes = uint64_t{64} << 20;
  /// Of a JSON file: while it is read it takes many times as much. YAML: ConfigValue::kMaxBytes.
  uint64_t max_json_bytes = uint64_t{16} << 20;
  /// Of all plain values, images decoded. They are in RAM at once.
  uint64_t max_bytes = uint64_t{1} << 30;
  int64_t max_pixels = 64'000'000;  ///< Of an image, before it is decoded.
};

/// Reads a directory of IDF values, images and other files, one for each entity.
///
///     DIR/prior.yaml                                 "time:" of all snapshots, if given
///     DIR/Objects/Things.type.xml                    what the values of a core segment are
///     DIR/Objects/Things/kitchen.type.xml            ... of a provider segment
///     DIR/Objects/Things/kitchen/blue-cup.yaml       entity Objects/Things/kitchen/blue-cup
///
/// Names whose first character is a dot are passed over; symbolic links are followed within the
/// directory. The provider of all instances is "prior"; their time that of prior.yaml, else when
/// the file was last changed.
/// Errors: kNotFound where there is no directory; else kInvalidArgument with all problems, a line
/// each.
/// Source: docs/prior.md.
Result<PriorKnowledge> load_prior(const std::filesystem::path& directory,
                                  const PriorOptions& options = {});

}  // namespace engram::memory
