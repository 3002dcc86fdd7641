// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: folders of images and one table.

#include "datasets/folders/tables_reader.h"

namespace engram::datasets {

/// Returns true if a folder has images, or one subfolder with images, and one table.
[[nodiscard]] bool is_images_folder(const std::filesystem::path& folder);

/// Errors: kInvalidArgument if it is not certain which files belong together or what their times
/// are, saying what was found and which option is needed.
Result<std::unique_ptr<RecordingReader>> open_images_folder(const std::filesystem::path& folder,
                                                            const ReadingOptions& options);

/// What the name of a column says about times: "timestamp [ns]", "time_ms", "t(s)". `unit` is empty
/// if the name has no unit or is not the name of a time.
struct TimeName {
  bool is_time = false;
  std::optional<TimeUnit> unit;
};
[[nodiscard]] TimeName time_name(std::string_view column);

}  // namespace engram::datasets
