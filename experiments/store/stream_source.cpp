// SPDX-License-Identifier: Apache-2.0
#include "store/stream_source.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "datasets/drawn_scene.h"
#include "datasets/media/table.h"
#include "datasets/media/video_reader.h"
#include "store/store_measure.h"

namespace engram::experiments {

namespace fs = std::filesystem;

namespace {

/// Makes a smooth motion, for recordings without a table of joints.
JointRow made_joints(size_t row) {
  JointRow joints{};
  for (size_t i = 0; i < kJoints; ++i)
    joints[i] = std::sin(0.03 * static_cast<double>(row) + static_cast<double>(i));
  return joints;
}

struct FoundFiles {
  std::vector<fs::path> videos;
  std::map<std::string, fs::path> tables;  ///< Keyed by the stem of the file name.
};

Result<FoundFiles> find_files(const fs::path& folder) {
  FoundFiles found;
  ENGRAM_ASSIGN_OR_RETURN(found.videos, files_below(folder, ".mp4"));
  ENGRAM_ASSIGN_OR_RETURN(const auto tables, files_below(folder, ".csv"));
  for (const fs::path& path : tables) found.tables.emplace(path.stem().string(), path);
  const auto is_alone = [&](const fs::path& video) {
    return !found.tables.contains(video.stem().string());
  };
  // Real and made-up joints must not be mixed, since they compress differently.
  if (!std::ranges::all_of(found.videos, is_alone)) std::erase_if(found.videos, is_alone);
  if (found.videos.empty())
    return not_found("recordings '{}': found no *.mp4, needs one or more", folder.string());
  return found;
}

Result<std::optional<datasets::Table>> table_of(const FoundFiles& files, const fs::path& video) {
  const auto at = files.tables.find(video.stem().string());
  if (at == files.tables.end()) return std::optional<datasets::Table>();
  datasets::Table::Options options;
  options.skip_columns = {"frame_index"};
  ENGRAM_ASSIGN_OR_RETURN(datasets::Table table, datasets::Table::read(at->second, options));
  return std::optional(std::move(table));
}

JointRow joints_of(const std::optional<datasets::Table>& table, size_t row) {
  JointRow joints = made_joints(row);
  if (!table || row >= table->rows()) return joints;
  const size_t columns = std::min(kJoints, table->columns().size());
  for (size_t i = 0; i < columns; ++i) joints[i] = table->columns()[i].values[row];
  return joints;
}

Status add_video(const fs::path& video, const std::optional<datasets::Table>& table,
                 size_t max_frames, StreamSource& source) {
  datasets::VideoReader::Options options;
  options.width = 640;
  options.height = 480;
  ENGRAM_ASSIGN_OR_RETURN(auto reader, datasets::VideoReader::open(video, options));
  for (size_t row = 0; source.frames.size() < max_frames; ++row) {
    ENGRAM_ASSIGN_OR_RETURN(auto frame, reader.next());
    if (!frame) return {};
    if (row % 2 != 0) continue;
    source.frames.push_back(std::move(frame->image));
    source.joints.push_back(joints_of(table, row));
  }
  return {};
}

}  // namespace

Result<StreamSource> read_recordings(const fs::path& recordings, size_t max_frames) {
  ENGRAM_ASSIGN_OR_RETURN(const FoundFiles files, find_files(recordings));
  StreamSource source;
  size_t used = 0, with_table = 0;
  for (const fs::path& video : files.videos) {
    if (source.frames.size() >= max_frames) break;
    ENGRAM_ASSIGN_OR_RETURN(const auto table, table_of(files, video));
    ENGRAM_RETURN_IF_ERROR(add_video(video, table, max_frames, source));
    used += 1;
    with_table += table ? 1 : 0;
  }
  if (source.frames.size() < 2)
    return not_found("recordings '{}': found {} frames, needs two", recordings.string(),
                     source.frames.size());
  source.description = fmt::format("{} frames of {} recordings, {} of them with joints",
                                   source.frames.size(), used, with_table);
  return source;
}

Result<StreamSource> render_scene(size_t frames) {
  datasets::SceneOptions options;
  options.width = 640;
  options.height = 480;
  options.rate_hz = 20;
  options.seconds = static_cast<double>(frames) / options.rate_hz;
  ENGRAM_ASSIGN_OR_RETURN(const datasets::Scene scene, datasets::Scene::create(options));
  StreamSource source;
  for (size_t i = 0; i < scene.frames(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(datasets::SceneFrame frame, scene.render(i));
    source.frames.push_back(std::move(frame.image));
    source.joints.push_back(made_joints(i));
  }
  source.description = fmt::format("{} frames of a rendered scene, made joints", frames);
  return source;
}

Result<StreamSource> load_stream_source(size_t max_frames) {
  const fs::path folder = recordings_folder();
  return folder.empty() ? render_scene(max_frames) : read_recordings(folder, max_frames);
}

}  // namespace engram::experiments
