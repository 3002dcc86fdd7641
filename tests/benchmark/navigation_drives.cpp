// SPDX-License-Identifier: Apache-2.0
// Drives a simulated robot among chairs that are pushed and persons who walk about, and prints what
// came of it. Usage: engram_navigation_drives STORE DRIVES SEED [--verbose]
#include <fmt/format.h>

#include <string>

#include "tests/server/navigation/drive_series.h"

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "usage: {} STORE DRIVES SEED [--verbose]\n", argv[0]);
    return 2;
  }
  engram::navigation::testing::SeriesOptions options;
  options.drives = std::stoi(argv[2]);
  options.seed = static_cast<uint32_t>(std::stoul(argv[3]));
  options.is_verbose = argc > 4 && std::string(argv[4]) == "--verbose";
  const auto series = engram::navigation::testing::drive_series(argv[1], options);
  if (!series.ok()) {
    fmt::print(stderr, "{}\n", series.status().to_string());
    return 1;
  }
  for (const std::string& failure : series->failures) fmt::print("not arrived: {}\n", failure);
  for (const auto& [kind, count] : series->endings) fmt::print("{}: {}\n", kind, count);
  fmt::print(
      "drives {}, arrived {}, collisions {} {}, min distance {:.3f} m, without reason {}, "
      "elsewhere {} (at most {:.2f} m), explained {}, replans {}, {:.1f} m in {:.0f} s, wall "
      "{:.1f} s\n",
      series->drives, series->arrived, series->collisions, series->first_collision,
      series->min_distance_m, series->without_reason, series->elsewhere, series->max_beside_m,
      series->explained, series->replans, series->travelled_m, series->driven_s, series->wall_s);
  return series->collisions == 0 && series->without_reason == 0 && series->elsewhere == 0 &&
                 series->explained == series->drives
             ? 0
             : 1;
}
