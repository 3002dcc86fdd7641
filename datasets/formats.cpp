// SPDX-License-Identifier: Apache-2.0
#include "datasets/formats.h"

#include <fmt/ranges.h>

#include "datasets/folders/folder_formats.h"
#include "datasets/hdf5/hdf5_formats.h"
#include "datasets/lerobot/lerobot_format.h"
#include "datasets/mcap/mcap_format.h"
#include "datasets/rosbag/rosbag_format.h"

namespace engram::datasets {

namespace {

std::string known_formats() {
  std::vector<std::string_view> names;
  for (const auto& format : all_recording_formats()) names.push_back(format->name());
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

const std::vector<std::unique_ptr<const RecordingFormat>>& all_recording_formats() {
  static const auto formats = [] {
    std::vector<std::unique_ptr<const RecordingFormat>> all;
    all.push_back(make_lerobot_format());
    all.push_back(make_mcap_format());
    all.push_back(make_rosbag_format());
    all.push_back(make_robomimic_format());
    all.push_back(make_aloha_format());
    all.push_back(make_tum_format());
    all.push_back(make_seven_scenes_format());
    all.push_back(make_euroc_format());
    // This one must be last, because it accepts any folder of images with a table.
    all.push_back(make_images_format());
    return all;
  }();
  return formats;
}

Result<const RecordingFormat*> find_recording_format(std::string_view name) {
  for (const auto& format : all_recording_formats())
    if (format->name() == name) return format.get();
  return invalid_argument("no format is called '{}', needs one of {}", name, known_formats());
}

Result<const RecordingFormat*> recognised_format(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    return not_found("'{}': there is no such file or folder", path.string());
  for (const auto& format : all_recording_formats())
    if (format->recognises(path)) return format.get();
  return invalid_argument("'{}': is none of the formats {}", path.string(), known_formats());
}

}  // namespace engram::datasets
