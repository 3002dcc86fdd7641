// SPDX-License-Identifier: Apache-2.0
// Both files of a map of the map_server, one after the other: YAML, a line with four dashes, PGM.
#include "server/navigation/map_file.h"

#include "tests/fuzz/fuzz_check.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  constexpr std::string_view kBetween = "\n----\n";
  const std::string_view all = engram::fuzzed_text(data, size);
  const size_t end = all.find(kBetween);
  const std::string_view yaml = all.substr(0, end);
  const std::string_view picture =
      end == std::string_view::npos ? std::string_view() : all.substr(end + kBetween.size());
  const auto map = engram::navigation::parse_map(yaml, picture, "map.yaml");
  if (!map.ok()) return 0;
  ENGRAM_CHECK(map->frame.validate().ok(), "a frame that does not validate");
  ENGRAM_CHECK(map->costs.size() == map->frame.size(), "{} x {} costs of {} x {} cells",
               map->costs.rows, map->costs.cols, map->frame.rows, map->frame.columns);
  // Each pixel is at least a byte, so nobody makes a large map of a small file.
  ENGRAM_CHECK(map->costs.total() <= picture.size(), "{} cells of {} bytes", map->costs.total(),
               picture.size());
  return 0;
}
