// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/map_file.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "ltm/core/config.h"
#include "ltm/core/file.h"
#include "ltm/core/printable.h"
#include "server/navigation/occupancy_grid.h"
#include "server/navigation/pgm.h"

namespace engram::navigation {

namespace {

constexpr double kOccupiedThreshold = 0.65;
/// Less than 50 / 255, the darkness of the grey 205 that stands for unknown.
constexpr double kFreeThreshold = 0.196;
constexpr uint8_t kFreePixel = 254;
constexpr uint8_t kUnknownPixel = 205;
/// A P2 file of the largest map: five digits and a blank for each cell.
constexpr uint64_t kMaxFileBytes = uint64_t{GridFrame::kMaxCells} * 6 + 4096;

/// What the YAML file of a map says.
struct MapHeader {
  std::string image;
  MapMode mode = MapMode::kTrinary;
  double resolution_m = 0;
  PlanarPose origin;
  bool is_negated = false;
  double occupied_threshold = kOccupiedThreshold;
  double free_threshold = kFreeThreshold;
};

Result<bool> negate_of(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, value.text());
  if (text == "0" || text == "false") return false;
  if (text == "1" || text == "true") return true;
  return value.error(fmt::format("found '{}', needs 0 or 1", text));
}

Result<PlanarPose> origin_of(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<ConfigValue> numbers, value.list());
  if (numbers.size() != 3)
    return value.error(fmt::format("has {} numbers, needs x, y and heading", numbers.size()));
  PlanarPose origin;
  ENGRAM_ASSIGN_OR_RETURN(origin.x_m, numbers[0].number());
  ENGRAM_ASSIGN_OR_RETURN(origin.y_m, numbers[1].number());
  ENGRAM_ASSIGN_OR_RETURN(origin.heading_rad, numbers[2].number());
  return origin;
}

Result<MapHeader> read_map_header(const ConfigValue& top) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, top.map());
  MapHeader header;
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue image, map.require("image"));
  ENGRAM_ASSIGN_OR_RETURN(header.image, image.text());
  if (const auto mode = map.find("mode")) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string word, mode->text());
    const auto found = map_mode_from(word);
    if (!found.ok()) return mode->error(found.status());
    header.mode = *found;
  }
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue resolution, map.require("resolution"));
  ENGRAM_ASSIGN_OR_RETURN(header.resolution_m, resolution.number());
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue origin, map.require("origin"));
  ENGRAM_ASSIGN_OR_RETURN(header.origin, origin_of(origin));
  if (const auto negate = map.find("negate")) {
    ENGRAM_ASSIGN_OR_RETURN(header.is_negated, negate_of(*negate));
  }
  ENGRAM_RETURN_IF_ERROR(
      map.read("occupied_thresh", header.occupied_threshold, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.read("free_thresh", header.free_threshold, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (!(header.free_threshold >= 0 && header.free_threshold < header.occupied_threshold &&
        header.occupied_threshold <= 1))
    return top.error(
        fmt::format("free_thresh is {} and occupied_thresh {}, needs 0 <= free_thresh "
                    "< occupied_thresh <= 1",
                    header.free_threshold, header.occupied_threshold));
  return header;
}

/// -1 is unknown.
int occupancy_of_pixel(const MapHeader& header, int pixel, int max_value) {
  const double light = static_cast<double>(pixel) / max_value;
  const double occupied = header.is_negated ? light : 1 - light;
  if (header.mode == MapMode::kRaw) {
    // Raw pixels are counted, not measured: 255 stands for unknown in a file of 8 bits.
    const int value = static_cast<int>(std::lround(light * 255));
    return value <= 100 ? value : -1;
  }
  if (occupied > header.occupied_threshold) return 100;
  if (occupied < header.free_threshold) return 0;
  if (header.mode == MapMode::kTrinary) return -1;
  return static_cast<int>(std::lround((occupied - header.free_threshold) /
                                      (header.occupied_threshold - header.free_threshold) * 100));
}

Result<CostMap> map_of_picture(const MapHeader& header, std::string_view bytes,
                               const std::string& name) {
  ENGRAM_ASSIGN_OR_RETURN(const GreyPicture picture, parse_pgm(bytes, name));
  CostMap map;
  map.frame = {picture.pixels.rows, picture.pixels.cols, header.resolution_m, header.origin};
  ENGRAM_RETURN_IF_ERROR(map.frame.validate().with_context(name));
  map.costs.create(map.frame.size(), CV_8UC1);
  for (int row = 0; row < map.frame.rows; ++row) {
    // Pictures begin at the top, maps at the lowest y.
    const auto* pixels = picture.pixels.ptr<uint16_t>(map.frame.rows - 1 - row);
    auto* costs = map.costs.ptr<uint8_t>(row);
    for (int column = 0; column < map.frame.columns; ++column)
      costs[column] =
          cost_of_occupancy(occupancy_of_pixel(header, pixels[column], picture.max_value));
  }
  return map;
}

uint8_t pixel_of_cost(uint8_t cost, MapMode mode) {
  if (mode == MapMode::kTrinary) {
    if (cost == kUnknownCost) return kUnknownPixel;
    return cost == kLethalCost ? 0 : kFreePixel;
  }
  const int occupancy = occupancy_of_cost(cost);
  if (mode == MapMode::kRaw) return static_cast<uint8_t>(occupancy < 0 ? 255 : occupancy);
  return static_cast<uint8_t>(std::lround(255 * (1 - occupancy / 100.0)));
}

/// Whether a name may stand between quotes in YAML as it is.
bool is_plain_text(const std::string& name) {
  return std::none_of(name.begin(), name.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return c == '"' || c == '\\' || byte < 0x20 || byte == 0x7f;
  });
}

std::string yaml_of(const std::string& image, const CostMap& map, MapMode mode) {
  // With these limits all that is between them is spread, so scale keeps each occupancy.
  const bool is_scale = mode == MapMode::kScale;
  const PlanarPose& origin = map.frame.pose_world_map;
  return fmt::format(
      "image: \"{}\"\nmode: {}\nresolution: {}\norigin: [{}, {}, {}]\nnegate: 0\n"
      "occupied_thresh: {}\nfree_thresh: {}\n",
      image, to_string(mode), map.frame.resolution_m, origin.x_m, origin.y_m, origin.heading_rad,
      is_scale ? 1.0 : kOccupiedThreshold, is_scale ? 0.0 : kFreeThreshold);
}

}  // namespace

std::string_view to_string(MapMode mode) {
  if (mode == MapMode::kScale) return "scale";
  return mode == MapMode::kRaw ? "raw" : "trinary";
}

Result<MapMode> map_mode_from(std::string_view word) {
  for (const MapMode mode : {MapMode::kTrinary, MapMode::kScale, MapMode::kRaw})
    if (to_string(mode) == word) return mode;
  return invalid_argument("found mode '{}', needs trinary, scale or raw", word);
}

Result<CostMap> read_map_file(const std::filesystem::path& yaml) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue top, ConfigValue::read_file(yaml));
  ENGRAM_ASSIGN_OR_RETURN(const MapHeader header, read_map_header(top));
  const std::filesystem::path image = yaml.parent_path() / header.image;
  ENGRAM_ASSIGN_OR_RETURN(const File file, File::open(image, File::Mode::kRead));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  if (size > kMaxFileBytes)
    return invalid_argument("{}: has {} bytes, needs at most {}", image.string(), size,
                            kMaxFileBytes);
  std::string bytes(size, '\0');
  ENGRAM_RETURN_IF_ERROR(file.read_at(0, std::as_writable_bytes(std::span(bytes))));
  return map_of_picture(header, bytes, image.string());
}

Result<CostMap> parse_map(std::string_view yaml, std::string_view picture,
                          const std::string& name) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue top, ConfigValue::parse(yaml, name));
  ENGRAM_ASSIGN_OR_RETURN(const MapHeader header, read_map_header(top));
  return map_of_picture(header, picture, header.image);
}

Status write_map_file(const std::filesystem::path& yaml, const CostMap& map, MapMode mode) {
  if (yaml.stem().empty())
    return invalid_argument("map: '{}' has no name, needs one such as map.yaml", yaml.string());
  if (mode == MapMode::kScale && cv::countNonZero(map.costs == kUnknownCost) > 0)
    return invalid_argument(
        "{}: the map has unknown cells, which mode scale cannot tell; needs trinary or raw",
        yaml.string());
  cv::Mat pixels(map.frame.size(), CV_8UC1);
  for (int row = 0; row < map.frame.rows; ++row) {
    const auto* costs = map.costs.ptr<uint8_t>(row);
    auto* written = pixels.ptr<uint8_t>(map.frame.rows - 1 - row);
    for (int column = 0; column < map.frame.columns; ++column)
      written[column] = pixel_of_cost(costs[column], mode);
  }
  std::filesystem::path image = yaml;
  image.replace_extension(".pgm");
  if (image == yaml)
    return invalid_argument("map: '{}' is the name of its picture, needs another ending",
                            yaml.string());
  if (!is_plain_text(image.filename().string()))
    return invalid_argument(
        "map: the name '{}' has quotes, backslashes or control characters, needs one without",
        printable(image.filename().string()));
  const std::string picture = pgm_of(pixels);
  ENGRAM_RETURN_IF_ERROR(replace_file(image, std::as_bytes(std::span(picture))));
  const std::string text = yaml_of(image.filename().string(), map, mode);
  return replace_file(yaml, std::as_bytes(std::span(text)));
}

}  // namespace engram::navigation
