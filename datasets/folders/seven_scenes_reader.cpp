// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/seven_scenes_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>

#include "datasets/folders/folder_image.h"
#include "datasets/folders/later.h"
#include "datasets/recordings/folder_file.h"

namespace engram::datasets {

namespace {

constexpr double kHz = 30;
constexpr double kDepthPerMetre = 1000;
constexpr int64_t kUnknownDepth = 65535;
constexpr std::string_view kPrefix = "frame-";
constexpr size_t kDigits = 6;

/// Returns 12 for "frame-000012.color.png".
std::optional<uint32_t> frame_number(const std::string& name) {
  if (!name.starts_with(kPrefix) || name.size() < kPrefix.size() + kDigits) return std::nullopt;
  const char* begin = name.data() + kPrefix.size();
  uint32_t number = 0;
  const auto [end, error] = std::from_chars(begin, begin + kDigits, number);
  if (error != std::errc() || end != begin + kDigits) return std::nullopt;
  return number;
}

/// Lists the frames in order, each of them once.
std::vector<uint32_t> list_frames(const std::filesystem::path& folder) {
  std::vector<uint32_t> frames;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (const auto number = frame_number(entry.path().filename().string()))
      frames.push_back(*number);
  std::ranges::sort(frames);
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

std::vector<std::filesystem::path> list_sequences(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> sequences;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.is_directory(error) && entry.path().filename().string().starts_with("seq-"))
      sequences.push_back(entry.path());
  std::ranges::sort(sequences);
  if (sequences.empty() && !list_frames(folder).empty()) sequences.push_back(folder);
  return sequences;
}

/// Converts a rotation matrix to w x y z. The largest of the four is computed first, because that
/// loses the fewest digits.
std::vector<double> quaternion_of(const std::vector<double>& m) {
  const double x2 = 1 + m[0] - m[5] - m[10];
  const double y2 = 1 - m[0] + m[5] - m[10];
  const double z2 = 1 - m[0] - m[5] + m[10];
  const double w2 = 1 + m[0] + m[5] + m[10];
  std::array<double, 4> q{};
  if (w2 >= std::max({x2, y2, z2}))
    q = {w2, m[9] - m[6], m[2] - m[8], m[4] - m[1]};
  else if (x2 >= std::max(y2, z2))
    q = {m[9] - m[6], x2, m[1] + m[4], m[2] + m[8]};
  else if (y2 >= z2)
    q = {m[2] - m[8], m[1] + m[4], y2, m[6] + m[9]};
  else
    q = {m[4] - m[1], m[2] + m[8], m[6] + m[9], z2};
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm};
}

/// Reads a 4 x 4 matrix that transforms camera coordinates to world coordinates; returns nothing if
/// the file has no such matrix.
std::optional<idf::Data> read_pose(const std::filesystem::path& folder, const std::string& name) {
  const auto path = file_in_folder(folder, name);
  if (!path.ok()) return std::nullopt;
  std::ifstream file(*path);
  std::vector<double> m;
  for (double value = 0; m.size() <= 16 && file >> value;) m.push_back(value);
  const bool is_finite = std::ranges::all_of(m, [](double value) { return std::isfinite(value); });
  if (m.size() != 16 || !file.eof() || !is_finite) return std::nullopt;
  std::vector<double> orientation = quaternion_of(m);
  if (!std::isfinite(orientation[0])) return std::nullopt;
  return idf::Dict{{"position", idf::NdArray::take<double>({3}, {m[3], m[7], m[11]})},
                   {"orientation", idf::NdArray::take<double>({4}, std::move(orientation))},
                   {"matrix", idf::NdArray::take<double>({4, 4}, std::move(m))}};
}

}  // namespace

bool is_seven_scenes(const std::filesystem::path& folder) {
  const auto sequences = list_sequences(folder);
  return !sequences.empty() && !list_frames(sequences.front()).empty();
}

Result<std::unique_ptr<RecordingReader>> SevenScenesReader::open(
    const std::filesystem::path& folder, const ReadingOptions& options) {
  const double rate_hz = options.rate_hz > 0 ? options.rate_hz : kHz;
  if (!(rate_hz >= 1e-3 && rate_hz <= 1e6))
    return invalid_argument("'{}': a rate of {} Hz, needs 0.001 to 1e6", folder.string(), rate_hz);
  if (options.episode_gap <= Duration::zero())
    return invalid_argument("gap between episodes of {}, needs more than 0s",
                            to_string(options.episode_gap));
  std::unique_ptr<SevenScenesReader> reader(new SevenScenesReader(options, rate_hz));
  for (const auto& sequence : list_sequences(folder))
    if (options.episodes.empty() ||
        std::ranges::find(options.episodes, sequence.filename().string()) != options.episodes.end())
      if (!list_frames(sequence).empty()) reader->sequences_.push_back(sequence);
  if (reader->sequences_.empty())
    return invalid_argument("'{}': has no frame-000000.color.png, nor asked folders seq-XX of them",
                            folder.string());
  ENGRAM_RETURN_IF_ERROR(reader->add_stream("Vision/RGB", "color", options, {}));
  ENGRAM_RETURN_IF_ERROR(
      reader->add_stream("Vision/Depth", "depth", options,
                         {{"per_metre", kDepthPerMetre}, {"unknown", kUnknownDepth}}));
  ENGRAM_RETURN_IF_ERROR(reader->add_stream("RobotState/Localization", "pose", options, {}));
  return std::unique_ptr<RecordingReader>(std::move(reader));
}

Status SevenScenesReader::add_stream(std::string_view segment, const std::string& name,
                                     const ReadingOptions& options, idf::Dict attributes) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId entity, ltm::MemoryId::parse(segment));
  ENGRAM_ASSIGN_OR_RETURN(entity, entity.child(options.provider));
  ENGRAM_ASSIGN_OR_RETURN(entity, entity.child(name));
  streams_.push_back({entity, name, 0, std::move(attributes)});
  return {};
}

void SevenScenesReader::add(size_t stream, Time time, std::optional<idf::Data> value,
                            ltm::Commit& commit) {
  if (!value) {
    ++report_.damaged;
    return;
  }
  commit.updates.push_back(imported(streams_[stream].entity, time, *std::move(value)));
}

Result<std::optional<RecordingReader::Moment>> SevenScenesReader::next() {
  if (sequence_ == sequences_.size()) return std::optional<Moment>();
  const std::filesystem::path& folder = sequences_[sequence_];
  Moment moment;
  if (frames_.empty()) {
    frames_ = list_frames(folder);
    frame_ = 0;
    if (frames_.empty()) return data_loss("'{}': its frames are gone", folder.string());
    moment.begins =
        RecordingEpisode{"7scenes", folder.filename().string(), start_, {{"rate_hz", rate_hz_}}};
  }
  const uint32_t number = frames_[frame_];
  ENGRAM_ASSIGN_OR_RETURN(const Time time,
                          later(start_, Duration(std::llround(number * (1e9 / rate_hz_)))));
  const std::string name = fmt::format("{}{:06}", kPrefix, number);
  add(0, time, folder_image(folder, name + ".color.png", false), moment.commit);
  add(1, time, folder_image(folder, name + ".depth.png", true), moment.commit);
  add(2, time, read_pose(folder, name + ".pose.txt"), moment.commit);
  if (++frame_ == frames_.size()) {
    frames_.clear();
    ++sequence_;
    ENGRAM_ASSIGN_OR_RETURN(start_, later(time, gap_));
  }
  return std::optional(std::move(moment));
}

}  // namespace engram::datasets
