// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/file_format.h"

#include <fstream>

namespace engram::datasets {

namespace {

class MadeFormat final : public RecordingFormat {
 public:
  explicit MadeFormat(const FileFormat& parts) : parts_(parts) {}

  [[nodiscard]] std::string_view name() const override { return parts_.name; }
  [[nodiscard]] std::string_view about() const override { return parts_.about; }

  [[nodiscard]] bool recognises(const std::filesystem::path& path) const override {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return false;
    std::ifstream file(path, std::ios::binary);
    std::string start(parts_.start.size(), '\0');
    file.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<size_t>(file.gcount()));
    // A file that is cut off is recognised here; opening it reports what is wrong.
    if (!start.empty()) return parts_.start.starts_with(start);
    return path.extension() == parts_.extension;
  }

  [[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(
      const std::filesystem::path& path, const ReadingOptions& options) const override {
    return parts_.open(path, options);
  }

  [[nodiscard]] bool can_write() const override { return true; }

  [[nodiscard]] Result<NotHeld> not_held(ltm::Recall& recall, const ltm::Query& query,
                                         const WritingOptions& options) const override {
    return parts_.not_held(recall, query, options);
  }

  [[nodiscard]] Result<ExportReport> write(ltm::Recall& recall, const ltm::Query& query,
                                           const std::filesystem::path& path,
                                           const WritingOptions& options,
                                           const ProgressSink& progress,
                                           const std::stop_token& stop) const override {
    return parts_.write({recall, query, options, progress, stop}, path);
  }

 private:
  FileFormat parts_;
};

}  // namespace

std::unique_ptr<const RecordingFormat> make_file_format(const FileFormat& parts) {
  return std::make_unique<MadeFormat>(parts);
}

}  // namespace engram::datasets
