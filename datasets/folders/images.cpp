// SPDX-License-Identifier: Apache-2.0
// Folders of images with a table of their times, and EuRoC's, which have one for each sensor.
#include "datasets/folders/euroc_folder.h"
#include "datasets/folders/folder_formats.h"
#include "datasets/folders/images_folder.h"

namespace engram::datasets {

namespace {

class ImagesFormat final : public RecordingFormat {
 public:
  [[nodiscard]] std::string_view name() const override { return "images"; }
  [[nodiscard]] std::string_view about() const override {
    return "a folder of PNG or JPEG files and a table of their times";
  }
  [[nodiscard]] bool recognises(const std::filesystem::path& path) const override {
    return is_images_folder(path);
  }
  [[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(
      const std::filesystem::path& path, const ReadingOptions& options) const override {
    std::error_code ignored;
    if (!std::filesystem::is_directory(path, ignored))
      return not_found("'{}': there is no such folder", path.string());
    return open_images_folder(path, options);
  }
};

class EurocFormat final : public RecordingFormat {
 public:
  [[nodiscard]] std::string_view name() const override { return "euroc"; }
  [[nodiscard]] std::string_view about() const override {
    return "folders mav0 of the EuRoC MAV data set";
  }
  [[nodiscard]] bool recognises(const std::filesystem::path& path) const override {
    return is_euroc_folder(path);
  }
  [[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(
      const std::filesystem::path& path, const ReadingOptions& options) const override {
    std::error_code ignored;
    if (!std::filesystem::is_directory(path, ignored))
      return not_found("'{}': there is no such folder", path.string());
    return open_euroc_folder(path, options);
  }
};

}  // namespace

std::unique_ptr<const RecordingFormat> make_images_format() {
  return std::make_unique<ImagesFormat>();
}

std::unique_ptr<const RecordingFormat> make_euroc_format() {
  return std::make_unique<EurocFormat>();
}

}  // namespace engram::datasets
