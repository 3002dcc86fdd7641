// SPDX-License-Identifier: Apache-2.0
#include "learning/number_data.h"

#include "datasets/media/table.h"
#include "store/store_measure.h"

namespace engram::experiments {

namespace fs = std::filesystem;

namespace {

Result<NumberRecording> read_recording(const fs::path& file,
                                       const std::vector<std::string>& prefixes, size_t stride) {
  ENGRAM_ASSIGN_OR_RETURN(const auto table, datasets::Table::read(file, {}));
  NumberRecording recording{file.stem().string(), {}, {}};
  std::vector<const datasets::TableColumn*> columns;
  for (const std::string& prefix : prefixes)
    for (const auto& column : table.columns())
      if (column.name.starts_with(prefix)) {
        columns.push_back(&column);
        recording.columns.push_back(column.name);
      }
  for (size_t row = 0; row < table.rows(); row += stride)
    for (const auto* column : columns) recording.rows.push_back(column->values[row]);
  return recording;
}

}  // namespace

Result<std::vector<NumberRecording>> read_numbers(const fs::path& folder,
                                                  const std::vector<std::string>& prefixes,
                                                  size_t stride) {
  ENGRAM_ASSIGN_OR_RETURN(const auto files, files_below(folder, ".csv"));
  std::vector<NumberRecording> recordings;
  for (const fs::path& file : files) {
    ENGRAM_ASSIGN_OR_RETURN(auto recording, read_recording(file, prefixes, stride));
    if (recording.columns.empty()) continue;
    if (!recordings.empty() && recording.columns != recordings[0].columns)
      return invalid_argument("recording '{}': {} columns '{}...', others than those of '{}'",
                              recording.name, recording.columns.size(), recording.columns[0],
                              recordings[0].name);
    recordings.push_back(std::move(recording));
  }
  if (recordings.empty())
    return not_found("folder '{}': found no table with columns '{}...'", folder.string(),
                     prefixes.front());
  return recordings;
}

}  // namespace engram::experiments
