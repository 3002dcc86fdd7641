// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/euroc_folder.h"

#include <algorithm>

#include "datasets/folders/tables_reader.h"
#include "datasets/recordings/folder_file.h"
#include "ltm/core/file.h"

namespace engram::datasets {

namespace {

constexpr uintmax_t kMaxYamlBytes = 1 << 20;

/// A kind of sensor: how the names of its folders begin, and its columns after the time.
struct Sensor {
  std::string_view start;
  std::string_view memory;
  std::string_view segment;
  std::vector<TableMember> members;  ///< Empty for a camera.

  /// The number of columns, including the time.
  [[nodiscard]] size_t columns() const {
    size_t count = 1;
    for (const TableMember& member : members) count += member.columns.size();
    return members.empty() ? 2 : count;
  }
};

const std::vector<Sensor>& sensors() {
  static const std::vector<Sensor> all{
      {"cam", "Vision", "RGB", {}},
      {"imu",
       "RobotState",
       "Proprioception",
       {{"angular_velocity", {1, 2, 3}, true}, {"linear_acceleration", {4, 5, 6}, true}}},
      {"leica", "RobotState", "Localization", {{"position", {1, 2, 3}, true}}},
      {"vicon",
       "RobotState",
       "Localization",
       {{"position", {1, 2, 3}, true}, {"orientation", {4, 5, 6, 7}, true}}},
      {"state_groundtruth_estimate",
       "RobotState",
       "Localization",
       {{"position", {1, 2, 3}, true},
        {"orientation", {4, 5, 6, 7}, true},
        {"velocity", {8, 9, 10}, true},
        {"gyroscope_bias", {11, 12, 13}, true},
        {"accelerometer_bias", {14, 15, 16}, true}}}};
  return all;
}

std::filesystem::path sensor_folder(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::is_directory(folder / "mav0", error) ? folder / "mav0" : folder;
}

/// Reads sensor.yaml of a sensor; empty if it is missing or too large.
std::string sensor_text(const std::filesystem::path& folder, const std::string& sensor) {
  const auto path = file_in_folder(folder, sensor + "/sensor.yaml");
  std::error_code error;
  if (!path.ok() || std::filesystem::file_size(*path, error) > kMaxYamlBytes || error) return "";
  const auto text = read_file(*path);
  return text.ok() ? std::string(as_text(text->bytes())) : "";
}

Result<TimedTable> table_of(const std::filesystem::path& folder, const std::string& name,
                            const Sensor& sensor, const ReadingOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const auto path, file_in_folder(folder, name + "/data.csv"));
  ENGRAM_ASSIGN_OR_RETURN(TableLines lines, TableLines::open(path));
  if (lines.names().size() != sensor.columns())
    return invalid_argument("'{}': line 1 has {} columns, needs {}", path.string(),
                            lines.names().size(), sensor.columns());
  ENGRAM_ASSIGN_OR_RETURN(auto entity, ltm::MemoryId::from_names({std::string(sensor.memory),
                                                                  std::string(sensor.segment),
                                                                  options.provider, name}));
  TablePart part;
  part.stream = {std::move(entity), name, 0, {}};
  if (std::string text = sensor_text(folder, name); !text.empty())
    part.stream.attributes.set("sensor", std::move(text));
  part.kind = sensor.members.empty() ? TablePart::Kind::kImage : TablePart::Kind::kNumbers;
  part.members = sensor.members;
  TimedTable table{.lines = std::move(lines)};
  table.parts.push_back(std::move(part));
  table.time_column = 0;
  table.images = folder / name / "data";
  if (sensor.members.empty()) table.file_column = 1;
  return table;
}

}  // namespace

bool is_euroc_folder(const std::filesystem::path& folder) {
  std::error_code error;
  const auto sensors = sensor_folder(folder);
  return std::filesystem::is_regular_file(sensors / "cam0" / "data.csv", error) ||
         std::filesystem::is_regular_file(sensors / "imu0" / "data.csv", error);
}

Result<std::unique_ptr<RecordingReader>> open_euroc_folder(const std::filesystem::path& folder,
                                                           const ReadingOptions& options) {
  const auto root = sensor_folder(folder);
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(root, error))
    if (std::filesystem::exists(entry.path() / "data.csv", error))
      names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  std::vector<TimedTable> tables;
  ReadingReport met;
  for (const std::string& name : names) {
    const auto sensor = std::ranges::find_if(
        sensors(), [&](const Sensor& one) { return name.starts_with(one.start); });
    // The names of folders are all that tells the kind of a sensor, so unknown ones are reported.
    if (sensor == sensors().end()) {
      ++met.not_carried["folder '" + name + "': no known sensor"];
      continue;
    }
    ENGRAM_ASSIGN_OR_RETURN(TimedTable table, table_of(root, name, *sensor, options));
    tables.push_back(std::move(table));
  }
  if (tables.empty())
    return invalid_argument("'{}': has no folder cam0, imu0, ... with a data.csv", root.string());
  return TablesReader::create("euroc", std::move(tables), std::move(met), options);
}

}  // namespace engram::datasets
