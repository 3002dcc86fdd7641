// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "datasets/recordings/exported_streams.h"

namespace engram::datasets {

/// Describes a format whose recordings are single files that all begin with the same bytes.
struct FileFormat {
  std::string_view name;
  std::string_view about;
  std::string_view start;      ///< The first bytes of every file; a cut-off file has fewer.
  std::string_view extension;  ///< ".bag"; empty files are recognised by it.

  // These have the contracts of the functions of RecordingFormat.
  Result<std::unique_ptr<RecordingReader>> (*open)(const std::filesystem::path& path,
                                                   const ReadingOptions& options);
  Result<NotHeld> (*not_held)(ltm::Recall& recall, const ltm::Query& query,
                              const WritingOptions& options);
  Result<ExportReport> (*write)(const ExportRequest& request, const std::filesystem::path& path);
};

/// Makes a format that can be read and written.
[[nodiscard]] std::unique_ptr<const RecordingFormat> make_file_format(const FileFormat& parts);

}  // namespace engram::datasets
