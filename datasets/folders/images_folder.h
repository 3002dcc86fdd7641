// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: folders of images and one table.

#include "datasets/folders/tables_reader.h"

namespace engram::datasets {

/// Whether a folder has images, or one folder of them, and one table.
[[nodiscard]] bool is_images_folder(const std::filesystem::path& folder);

/// Errors: kInvalidArgument where it is not certain what belongs together or when it was, saying
/// what was found and what to say.
Result<std::unique_ptr<RecordingReader>> open_images_folder(const std::filesystem::path& folder,
                                                            const ReadingOptions& options);

/// The unit that the name of a column of times says: "timestamp [ns]", "time_ms", "t(s)".
/// Nothing where it says none, or is none of times.
struct TimeName {
  bool is_time = false;
  std::optional<TimeUnit> unit;
};
[[nodiscard]] TimeName time_name(std::string_view column);

}  // namespace engram::datasets
