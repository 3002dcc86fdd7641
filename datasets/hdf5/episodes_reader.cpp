// SPDX-License-Identifier: Apache-2.0
#include "datasets/hdf5/episodes_reader.h"

#include <algorithm>
#include <cmath>

#include "datasets/hdf5/attributes.h"
#include "ltm/core/utf8.h"

namespace engram::datasets {

namespace {

constexpr int kMaxDepth = 16;
constexpr size_t kMaxArrays = 10'000;
constexpr double kSlowestHz = 1e-3;
constexpr double kFastestHz = 1e6;

/// Describes an array so that an export can write it in the same way.
idf::Dict describe(const h5::ArrayInfo& info) {
  idf::List row;
  for (size_t i = 1; i < info.shape.size(); ++i)
    row.emplace_back(static_cast<int64_t>(info.shape[i]));
  return {{"dtype", dtype_name(info.element)},
          {"row_shape", std::move(row)},
          {"text_bytes", static_cast<int64_t>(info.element.text_bytes)},
          {"chunk_rows", static_cast<int64_t>(info.chunk_rows)},
          {"gzip", static_cast<int64_t>(info.deflate_level)}};
}

}  // namespace

Result<std::unique_ptr<RecordingReader>> EpisodesReader::open(
    const Dialect& dialect, const std::vector<std::filesystem::path>& files,
    const ReadingOptions& options) {
  if (options.episode_gap <= Duration::zero())
    return invalid_argument("gap between episodes of {}, needs more than 0s",
                            to_string(options.episode_gap));
  std::unique_ptr<EpisodesReader> reader(new EpisodesReader(dialect, options));
  for (const std::filesystem::path& file : files) ENGRAM_RETURN_IF_ERROR(reader->add_file(file));
  ENGRAM_RETURN_IF_ERROR(reader->check_asked());
  reader->start_ = options.start.value_or(Time());
  return std::unique_ptr<RecordingReader>(std::move(reader));
}

Status EpisodesReader::add_file(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const h5::File file, h5::File::open(path));
  ENGRAM_ASSIGN_OR_RETURN(const auto groups, dialect_.episodes(file, path.stem().string()));
  Rate rate = dialect_.rate(file);
  if (options_.rate_hz > 0) rate = {options_.rate_hz};
  if (!(rate.hz >= kSlowestHz && rate.hz <= kFastestHz))
    return invalid_argument("'{}': a rate of {} Hz, needs {} to {}", path.string(), rate.hz,
                            kSlowestHz, kFastestHz);
  if (rate.is_assumed)
    report_.not_carried[fmt::format("times: no rate in the file, {} Hz assumed", rate.hz)] = 1;
  for (const EpisodeGroup& group : groups)
    if (options_.episodes.empty() ||
        std::ranges::find(options_.episodes, group.name) != options_.episodes.end())
      ENGRAM_RETURN_IF_ERROR(add_episode(file, group, rate.hz));
  return {};
}

Status EpisodesReader::check_asked() const {
  for (const std::string& name : options_.episodes)
    if (std::ranges::none_of(episodes_, [&](const auto& one) { return one.group.name == name; }))
      return not_found("episode '{}': is not in the recording", name);
  return {};
}

Status EpisodesReader::add_episode(const h5::File& file, const EpisodeGroup& group,
                                   double rate_hz) {
  Episode episode{file.path(), group, rate_hz, {}, {}};
  ENGRAM_RETURN_IF_ERROR(list_arrays(file, episode, "", 0));
  for (const std::string& name : episode.arrays) {
    ENGRAM_ASSIGN_OR_RETURN(const auto info, file.array_info(group.group + "/" + name));
    ENGRAM_RETURN_IF_ERROR(add_array(name, info));
    streams_[arrays_.find(name)->second.stream].values += info.rows();
    total_ += info.rows();
  }
  episodes_.push_back(std::move(episode));
  return {};
}

Status EpisodesReader::list_arrays(const h5::File& file, Episode& episode, const std::string& below,
                                   int depth) {
  const std::string path = episode.group.group + (below.empty() ? "" : "/" + below);
  // Links may form a cycle, so the depth is bounded.
  if (depth > kMaxDepth)
    return invalid_argument("'{}': '{}' lies deeper than {} groups", file.path().string(), path,
                            kMaxDepth);
  ENGRAM_ASSIGN_OR_RETURN(const auto found, file.list(path.empty() ? "/" : path));
  for (const std::string& one : found) {
    const std::string name = below.empty() ? one : below + "/" + one;
    const auto is_group = file.is_group(episode.group.group + "/" + name);
    if (!is_group.ok() || !is_utf8(one)) {
      ++report_.not_carried["links that lead nowhere"];
    } else if (*is_group) {
      episode.groups.push_back(name);
      ENGRAM_RETURN_IF_ERROR(list_arrays(file, episode, name, depth + 1));
    } else {
      ENGRAM_RETURN_IF_ERROR(list_array(file, episode, name));
    }
    if (episode.arrays.size() + episode.groups.size() > kMaxArrays)
      return invalid_argument("'{}': '{}' has more than {} arrays and groups", file.path().string(),
                              path, kMaxArrays);
  }
  return {};
}

Status EpisodesReader::list_array(const h5::File& file, Episode& episode, const std::string& name) {
  if (dialect_.is_description(name)) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto info, file.array_info(episode.group.group + "/" + name));
  const bool is_text = info.element.kind != h5::Kind::kOther && info.shape.size() == 1;
  if (info.rows() == 0)
    ++report_.not_carried["arrays without rows"];
  else if (info.element.is_number() || is_text)
    episode.arrays.push_back(name);
  else
    ++report_.not_carried["arrays of elements that are no numbers or texts"];
  return {};
}

Status EpisodesReader::add_array(const std::string& name, const h5::ArrayInfo& info) {
  if (arrays_.contains(name)) return {};
  const RowPlace place = dialect_.place(name, info);
  ENGRAM_ASSIGN_OR_RETURN(const auto entity,
                          entities_.take(place.memory, place.core, options_.provider, place.name));
  arrays_.emplace(name, Array{streams_.size(), place.role});
  streams_.push_back({entity, name, 0, describe(info)});
  return {};
}

Status EpisodesReader::begin_episode() {
  const Episode& episode = episodes_[episode_];
  if (!file_ || file_->path() != episode.file) {
    file_.reset();
    ENGRAM_ASSIGN_OR_RETURN(file_, h5::File::open(episode.file));
  }
  blocks_.clear();
  row_ = 0;
  rows_ = 0;
  for (const std::string& name : episode.arrays) {
    const std::string path = episode.group.group + "/" + name;
    ENGRAM_ASSIGN_OR_RETURN(auto info, file_->array_info(path));
    const Array& array = arrays_.find(name)->second;
    // If episodes differ in the type of an array, each uses the role of its own rows.
    const RowRole role = dialect_.place(name, info).role;
    rows_ = std::max(rows_, info.rows());
    blocks_.emplace_back(array.stream, RowBlocks(path, std::move(info), role));
  }
  is_begun_ = true;
  return {};
}

Result<RecordingEpisode> EpisodesReader::describe_episode() {
  const Episode& episode = episodes_[episode_];
  const std::string& group = episode.group.group;
  RecordingEpisode described{std::string(dialect_.name()), episode.group.name, start_, {}};
  described.attributes.set("attributes",
                           read_attributes(*file_, group.empty() ? "/" : group, report_));
  described.attributes.set("rate_hz", episode.rate_hz);
  idf::Dict objects;
  for (const auto& names : {episode.groups, episode.arrays})
    for (const std::string& name : names)
      if (idf::Dict found = read_attributes(*file_, group + "/" + name, report_); !found.empty())
        objects.set(name, std::move(found));
  if (!objects.empty()) described.attributes.set("objects", std::move(objects));
  if (episode_ == 0)
    if (idf::Dict file = dialect_.describe_file(*file_, report_); !file.empty())
      described.attributes.set("file", std::move(file));
  return described;
}

Result<Time> EpisodesReader::time_of(uint64_t row) const {
  const Episode& episode = episodes_[episode_];
  // A double has too few bits for nanoseconds beyond a day, so whole seconds are split off.
  const double seconds = static_cast<double>(row) / episode.rate_hz;
  const double whole = std::floor(seconds);
  constexpr double kMaxSeconds = 9.2e9;
  if (whole + to_seconds(start_.time_since_epoch()) > kMaxSeconds)
    return invalid_argument("'{}': row {} of '{}' would be later than times can be",
                            episode.file.string(), row, episode.group.name);
  const int64_t ns =
      static_cast<int64_t>(whole) * 1'000'000'000 + std::llround((seconds - whole) * 1e9);
  return start_ + Duration(ns);
}

Result<std::optional<RecordingReader::Moment>> EpisodesReader::next() {
  if (episode_ == episodes_.size()) return std::optional<Moment>();
  Moment moment;
  if (!is_begun_) {
    ENGRAM_RETURN_IF_ERROR(begin_episode());
    ENGRAM_ASSIGN_OR_RETURN(moment.begins, describe_episode());
  }
  ENGRAM_ASSIGN_OR_RETURN(const Time time, time_of(row_));
  for (auto& [stream, blocks] : blocks_) {
    if (row_ >= blocks.info().rows()) continue;
    auto value = blocks.value(*file_, row_, report_);
    if (!value) continue;
    moment.commit.updates.push_back(imported(streams_[stream].entity, time, *std::move(value)));
  }
  if (++row_ >= rows_) {
    is_begun_ = false;
    if (++episode_ < episodes_.size()) start_ = time + options_.episode_gap;
  }
  return std::optional(std::move(moment));
}

}  // namespace engram::datasets
