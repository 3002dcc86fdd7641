// SPDX-License-Identifier: Apache-2.0
// 7-Scenes: colour, depth and pose of each frame are separate files.
#include "datasets/folders/folder_formats.h"
#include "datasets/folders/seven_scenes_reader.h"

namespace engram::datasets {

namespace {

class SevenScenesFormat final : public RecordingFormat {
 public:
  [[nodiscard]] std::string_view name() const override { return "7scenes"; }
  [[nodiscard]] std::string_view about() const override {
    return "scenes or sequences of the 7-Scenes data set";
  }

  [[nodiscard]] bool recognises(const std::filesystem::path& path) const override {
    return is_seven_scenes(path);
  }

  [[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(
      const std::filesystem::path& path, const ReadingOptions& options) const override {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
      return not_found("'{}': there is no such folder", path.string());
    return SevenScenesReader::open(path, options);
  }
};

}  // namespace

std::unique_ptr<const RecordingFormat> make_seven_scenes_format() {
  return std::make_unique<SevenScenesFormat>();
}

}  // namespace engram::datasets
