// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "ltm/core/status.h"

namespace engram::navigation::testing {

struct SeriesOptions {
  int drives = 20;
  uint32_t seed = 1;
  bool is_verbose = false;  ///< Prints one line for each drive.
};

/// What came of many drives, as it really was and not as the robot saw it, among chairs that are
/// pushed and persons who walk about.
struct Series {
  int drives = 0;
  int arrived = 0;
  int collisions = 0;
  std::string first_collision;
  double min_distance_m = 1e9;
  int without_reason = 0;   ///< Ended otherwise than by arriving, and said no reason.
  int elsewhere = 0;        ///< Said that they arrived, and were not beside what was asked for.
  double max_beside_m = 0;  ///< The largest distance from there of those that arrived.
  int explained = 0;        ///< "Why?" led from the last event to the words that were said.
  int replans = 0;
  double travelled_m = 0;
  double driven_s = 0;
  double wall_s = 0;
  std::map<std::string, int> endings;  ///< By the kind of the last event.
  std::vector<std::string> failures;   ///< The reasons of those that did not arrive.
};

/// Makes drives, one after the other, in one memory. Goals are furniture, chairs, locations,
/// aliases and places; some are not free, some are unknown, and in some drives persons surround the
/// robot. Errors: those of the memory.
Result<Series> drive_series(const std::filesystem::path& store, const SeriesOptions& options);

}  // namespace engram::navigation::testing
