// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/lerobot_format.h"

#include "datasets/lerobot/lerobot_reader.h"

namespace engram::datasets {

namespace {

class LerobotFormat final : public RecordingFormat {
 public:
  [[nodiscard]] std::string_view name() const override { return "lerobot"; }
  [[nodiscard]] std::string_view about() const override {
    return "LeRobot data sets v2.0, v2.1 and v3.0: a folder with meta/info.json";
  }

  [[nodiscard]] bool recognises(const std::filesystem::path& path) const override {
    std::error_code error;
    return std::filesystem::is_regular_file(path / "meta" / "info.json", error);
  }

  [[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(
      const std::filesystem::path& path, const ReadingOptions& options) const override {
    ENGRAM_ASSIGN_OR_RETURN(auto description, lerobot::read_description(path));
    return lerobot::make_reader(std::move(description), options);
  }
};

}  // namespace

std::unique_ptr<const RecordingFormat> make_lerobot_format() {
  return std::make_unique<LerobotFormat>();
}

}  // namespace engram::datasets
