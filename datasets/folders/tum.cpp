// SPDX-License-Identifier: Apache-2.0
// TUM RGB-D: images in folders, tables of their times, a table of poses.
#include "datasets/folders/folder_formats.h"
#include "datasets/folders/tum_reader.h"

namespace engram::datasets {

namespace {

class TumFormat final : public RecordingFormat {
 public:
  [[nodiscard]] std::string_view name() const override { return "tum"; }
  [[nodiscard]] std::string_view about() const override {
    return "folders of the TUM RGB-D benchmark";
  }

  [[nodiscard]] bool recognises(const std::filesystem::path& path) const override {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path / "rgb.txt", ignored) ||
           std::filesystem::is_regular_file(path / "groundtruth.txt", ignored);
  }

  [[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(
      const std::filesystem::path& path, const ReadingOptions& options) const override {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
      return not_found("'{}': there is no such folder", path.string());
    return TumReader::open(path, options);
  }
};

}  // namespace

std::unique_ptr<const RecordingFormat> make_tum_format() {
  return std::make_unique<TumFormat>();
}

}  // namespace engram::datasets
