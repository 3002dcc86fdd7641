// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_format.h"

#include <array>
#include <fstream>

#include "datasets/mcap/mcap_export.h"
#include "datasets/mcap/mcap_reader.h"

namespace engram::datasets {

namespace {

class McapFormat final : public RecordingFormat {
 public:
  [[nodiscard]] std::string_view name() const override { return "mcap"; }
  [[nodiscard]] std::string_view about() const override {
    return "MCAP: messages of ROS 2, ROS 1 and others, as rosbag2 records them";
  }

  [[nodiscard]] bool recognises(const std::filesystem::path& path) const override {
    std::ifstream file(path, std::ios::binary);
    std::array<char, 8> start{};
    file.read(start.data(), start.size());
    const auto count = static_cast<size_t>(file.gcount());
    if (count > 0) return std::string_view(start.data(), count) == mcap::kMagic;
    std::error_code error;
    return path.extension() == ".mcap" && std::filesystem::is_regular_file(path, error);
  }

  [[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(
      const std::filesystem::path& path, const ReadingOptions& options) const override {
    return mcap::McapReader::open(path, options);
  }

  [[nodiscard]] bool can_write() const override { return true; }

  [[nodiscard]] Result<std::map<std::string, uint64_t, std::less<>>> not_held(
      ltm::Recall& recall, const ltm::Query& query, const WritingOptions& options) const override {
    ENGRAM_ASSIGN_OR_RETURN(auto plan, mcap::plan_export(recall, query, options));
    return std::move(plan.not_held);
  }

  [[nodiscard]] Result<ExportReport> write(ltm::Recall& recall, const ltm::Query& query,
                                           const std::filesystem::path& path,
                                           const WritingOptions& options,
                                           const ProgressSink& progress,
                                           const std::stop_token& stop) const override {
    return mcap::export_mcap(recall, query, path, options, progress, stop);
  }
};

}  // namespace

std::unique_ptr<const RecordingFormat> make_mcap_format() {
  return std::make_unique<McapFormat>();
}

}  // namespace engram::datasets
