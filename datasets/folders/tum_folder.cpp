// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/tum_folder.h"

#include "datasets/folders/tables_reader.h"
#include "datasets/recordings/folder_file.h"

namespace engram::datasets {

namespace {

constexpr double kTumDepthPerMetre = 5000;

/// A table of the format; the folder need not have it.
struct TumTable {
  std::string name;
  std::string memory;
  std::string segment;
  TablePart::Kind kind = TablePart::Kind::kNumbers;
  std::vector<std::string> columns;  ///< Columns after the time.
  std::vector<TableMember> members;  ///< For tables of numbers.
};

const std::vector<TumTable>& tables() {
  using Kind = TablePart::Kind;
  static const std::vector<TumTable> all{
      {"rgb", "Vision", "RGB", Kind::kImage, {"filename"}, {}},
      {"depth", "Vision", "Depth", Kind::kDepth, {"filename"}, {}},
      {"groundtruth",
       "RobotState",
       "Localization",
       Kind::kNumbers,
       {"tx", "ty", "tz", "qx", "qy", "qz", "qw"},
       {{"position", {1, 2, 3}, true}, {"orientation", {7, 4, 5, 6}, true}}},
      {"accelerometer",
       "RobotState",
       "Proprioception",
       Kind::kNumbers,
       {"ax", "ay", "az"},
       {{"values", {1, 2, 3}, true}}}};
  return all;
}

Result<TimedTable> timed(const TumTable& table, const std::filesystem::path& folder,
                         const ReadingOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const auto path, file_in_folder(folder, table.name + ".txt"));
  std::vector<std::string> columns{"timestamp"};
  columns.insert(columns.end(), table.columns.begin(), table.columns.end());
  ENGRAM_ASSIGN_OR_RETURN(TableLines lines, TableLines::open(path, std::move(columns)));
  ENGRAM_ASSIGN_OR_RETURN(auto entity, ltm::MemoryId::from_names({table.memory, table.segment,
                                                                  options.provider, table.name}));
  TablePart part{{std::move(entity), table.name, 0, {}}, table.kind, table.members};
  if (table.kind == TablePart::Kind::kDepth)
    part.stream.attributes.set("per_metre", kTumDepthPerMetre);
  TimedTable made{.lines = std::move(lines)};
  made.parts.push_back(std::move(part));
  made.time_column = 0;
  made.unit = TimeUnit::kSeconds;
  made.images = folder;
  if (table.kind != TablePart::Kind::kNumbers) made.file_column = 1;
  return made;
}

}  // namespace

Result<std::unique_ptr<RecordingReader>> open_tum_folder(const std::filesystem::path& folder,
                                                         const ReadingOptions& options) {
  std::vector<TimedTable> found;
  for (const TumTable& table : tables()) {
    std::error_code ignored;
    if (!std::filesystem::exists(folder / (table.name + ".txt"), ignored)) continue;
    ENGRAM_ASSIGN_OR_RETURN(TimedTable made, timed(table, folder, options));
    found.push_back(std::move(made));
  }
  if (found.empty())
    return invalid_argument("'{}': has none of rgb.txt, depth.txt, groundtruth.txt",
                            folder.string());
  return TablesReader::create("tum", std::move(found), {}, options);
}

}  // namespace engram::datasets
