// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/rosbag_format.h"

#include <array>
#include <fstream>

#include "datasets/rosbag/bag_reader.h"

namespace engram::datasets {

namespace {

class RosbagFormat final : public RecordingFormat {
 public:
  [[nodiscard]] std::string_view name() const override { return "rosbag"; }
  [[nodiscard]] std::string_view about() const override {
    return "bags of ROS 1: messages of any type, as rosbag records them";
  }

  [[nodiscard]] bool recognises(const std::filesystem::path& path) const override {
    std::ifstream file(path, std::ios::binary);
    std::array<char, rosbag::kMagic.size()> start{};
    file.read(start.data(), start.size());
    const std::string_view found(start.data(), static_cast<size_t>(file.gcount()));
    // Of another version, or cut off: what is wrong is told on opening.
    constexpr std::string_view kAnyVersion = "#ROSBAG V";
    if (!found.empty()) return found.starts_with(kAnyVersion) || kAnyVersion.starts_with(found);
    std::error_code error;
    return path.extension() == ".bag" && std::filesystem::is_regular_file(path, error);
  }

  [[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(
      const std::filesystem::path& path, const ReadingOptions& options) const override {
    return rosbag::BagReader::open(path, options);
  }
};

}  // namespace

std::unique_ptr<const RecordingFormat> make_rosbag_format() {
  return std::make_unique<RosbagFormat>();
}

}  // namespace engram::datasets
