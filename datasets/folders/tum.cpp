// SPDX-License-Identifier: Apache-2.0
// TUM RGB-D: images in folders, tables of their times, a table of poses.
#include "datasets/folders/folder_formats.h"
#include "datasets/folders/tum_folder.h"
#include "datasets/folders/tum_writer.h"

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
    return open_tum_folder(path, options);
  }

  [[nodiscard]] bool can_write() const override { return true; }

  [[nodiscard]] Result<std::map<std::string, uint64_t, std::less<>>> not_held(
      ltm::Recall& recall, const ltm::Query& query, const WritingOptions& options) const override {
    ENGRAM_ASSIGN_OR_RETURN(TumPlan plan, plan_tum(recall, query, options));
    return std::move(plan.not_held);
  }

  [[nodiscard]] Result<ExportReport> write(ltm::Recall& recall, const ltm::Query& query,
                                           const std::filesystem::path& path,
                                           const WritingOptions& options,
                                           const ProgressSink& progress,
                                           const std::stop_token& stop) const override {
    return write_tum(recall, query, path, options, progress, stop);
  }
};

}  // namespace

std::unique_ptr<const RecordingFormat> make_tum_format() {
  return std::make_unique<TumFormat>();
}

}  // namespace engram::datasets
