// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "server/navigation/cost_map.h"

namespace engram::navigation {

/// How the pixels of a map file are read, as the map_server of ROS defines it.
enum class MapMode : uint8_t {
  kTrinary,  ///< Occupied, free or unknown.
  kScale,    ///< What lies between the thresholds is spread over 0 to 100; nothing is unknown.
  kRaw,      ///< A pixel is an occupancy of 0 to 100; others are unknown.
};

[[nodiscard]] std::string_view to_string(MapMode mode);

/// Errors: kInvalidArgument naming the word and those that there are.
Result<MapMode> map_mode_from(std::string_view word);

/// Reads a map of the map_server: a YAML file that names a PGM file beside it (P2 or P5, up to 16
/// bits). Occupancies become costs as in occupancy_grid.h.
/// Errors: kInvalidArgument and kDataLoss naming file, what was found and what was needed;
/// kNotFound; kUnavailable. Source: docs/navigation.md, "Files of maps".
Result<CostMap> read_map_file(const std::filesystem::path& yaml);

/// The same of the contents of both files; safe on hostile bytes. `name` is that of the YAML in
/// errors.
Result<CostMap> parse_map(std::string_view yaml, std::string_view picture, const std::string& name);

/// Writes `yaml` and a PGM file of the same name beside it, each replaced as a whole. kTrinary
/// keeps obstacles alone, because who reads such a map inflates it anew; the other two keep all
/// costs. Errors: kInvalidArgument where `yaml` has no name or one with quotes, backslashes or
/// control characters, or a map with unknown cells is written as kScale; kUnavailable;
/// kResourceExhausted.
Status write_map_file(const std::filesystem::path& yaml, const CostMap& map,
                      MapMode mode = MapMode::kTrinary);

}  // namespace engram::navigation
