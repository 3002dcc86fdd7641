// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "datasets/recordings/exported_streams.h"

namespace engram::datasets {

/// What a format is made of whose recordings are single files that begin with the same bytes.
struct FileFormat {
  std::string_view name;
  std::string_view about;
  std::string_view start;      ///< Of every file; of one that is cut off, what is there of it.
  std::string_view extension;  ///< ".bag"; by this, empty files are known.

  // As those of RecordingFormat.
  Result<std::unique_ptr<RecordingReader>> (*open)(const std::filesystem::path& path,
                                                   const ReadingOptions& options);
  Result<NotHeld> (*not_held)(ltm::Recall& recall, const ltm::Query& query,
                              const WritingOptions& options);
  Result<ExportReport> (*write)(const ExportRequest& request, const std::filesystem::path& path);
};

/// A format that can be read and written.
[[nodiscard]] std::unique_ptr<const RecordingFormat> make_file_format(const FileFormat& parts);

}  // namespace engram::datasets
