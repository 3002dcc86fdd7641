// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/lerobot_reader.h"

#include <algorithm>
#include <cmath>

#include "datasets/lerobot/episode_video.h"
#include "datasets/lerobot/lerobot_episodes.h"
#include "datasets/lerobot/step_numbers.h"
#include "datasets/lerobot/step_rows.h"
#include "datasets/recordings/folder_file.h"
#include "datasets/recordings/moment_order.h"
#include "datasets/recordings/read_image_file.h"

namespace engram::datasets::lerobot {

namespace {

constexpr const char* kImage = "image";
constexpr const char* kState = "state";
constexpr const char* kCamera = "camera";
// The maximum time of a row since the start of its episode.
constexpr Duration kLongestEpisode = std::chrono::seconds(200'000'000);

/// Returns true for columns that are not features of the robot.
bool is_bookkeeping(const std::string& key) {
  static const std::vector<std::string> keys{"timestamp", "frame_index", "episode_index", "index",
                                             "task_index"};
  return std::ranges::find(keys, key) != keys.end();
}

std::string without(const std::string& key, std::string_view prefix) {
  return key.starts_with(prefix) ? key.substr(prefix.size()) : key;
}

/// The segment and provider that the values of a feature go to.
struct Place {
  std::string memory;
  std::string segment;
  std::string name;
};

Place place_of(const Feature& feature) {
  const std::string& key = feature.key;
  if (feature.is_picture())
    return {"Vision", key.find("depth") == std::string::npos ? "RGB" : "Depth", last_part(key)};
  if (key.starts_with("observation."))
    return {"RobotState", "Proprioception", without(key, "observation.")};
  if (key.starts_with("action")) return {"Skills", "Commands", key};
  return {"Tasks", "Feedback", without(key, "next.")};
}

/// A feature, its entity, and the data of the current episode that contain it.
struct Source {
  Feature feature;
  ltm::MemoryId entity;
  size_t number = 0;  ///< The index among the features that are videos.
  std::optional<EpisodeVideo> video;
  VideoPart part;               ///< The part of the video that is the current episode.
  std::vector<size_t> columns;  ///< One column for each number, or the column of image names.
  std::optional<idf::NdArray> last_image;
};

class Reader final : public RecordingReader {
 public:
  Reader(Description description, const ReadingOptions& options)
      : description_(std::move(description)), options_(options), rows_(description_) {}

  Status prepare() {
    ENGRAM_RETURN_IF_ERROR(choose_episodes());
    size_t videos = 0;
    for (const Feature& feature : description_.features) {
      const size_t number = feature.kind == Feature::Kind::kVideo ? videos++ : 0;
      if (!is_bookkeeping(feature.key)) ENGRAM_RETURN_IF_ERROR(add_source(feature, number));
    }
    ENGRAM_ASSIGN_OR_RETURN(tasks_, read_tasks(description_));
    if (tasks_.size() < 2) return {};
    // If there is only one task, the descriptions of episodes are enough.
    ENGRAM_ASSIGN_OR_RETURN(task_entity_,
                            entities_.take("Tasks", "Feedback", options_.provider, "task"));
    streams_.push_back({task_entity_, "task_index", 0, {{"dtype", "int64"}}});
    return {};
  }

  [[nodiscard]] const std::vector<RecordingStream>& streams() const override { return streams_; }
  [[nodiscard]] uint64_t total() const override { return total_ * sources_.size(); }

  Result<std::optional<Moment>> next() override {
    while (!is_inside_ || step_ >= length_) {
      if (is_inside_) ENGRAM_RETURN_IF_ERROR(end_episode());
      if (episode_ >= episodes_.size()) return std::optional<Moment>();
      ENGRAM_RETURN_IF_ERROR(begin_episode());
    }
    ENGRAM_RETURN_IF_ERROR(rows_.next());
    ENGRAM_ASSIGN_OR_RETURN(const Time time, time_of_row());
    Moment moment;
    if (step_ == 0) moment.begins = description_of(episode(), time);
    ENGRAM_RETURN_IF_ERROR(add_task(time, moment.commit));
    for (Source& source : sources_) {
      ENGRAM_ASSIGN_OR_RETURN(auto value, value_of(source, time));
      if (value) moment.commit.updates.push_back(imported(source.entity, time, *std::move(value)));
    }
    ++step_;
    return std::optional(std::move(moment));
  }

 private:
  [[nodiscard]] const Episode& episode() const { return episodes_[episode_ - 1]; }

  Status choose_episodes() {
    std::vector<std::string> missing = options_.episodes;
    const uint64_t all = description_.episodes.size();
    for (Episode& episode : description_.episodes) {
      const auto asked = [&](const std::string& name) {
        return name == episode.name() || name == std::to_string(episode.index);
      };
      if (!options_.episodes.empty() && std::ranges::none_of(options_.episodes, asked)) continue;
      std::erase_if(missing, asked);
      std::error_code error;
      const std::filesystem::path table = description_.table_of(episode);
      const bool is_there = !csv_of(description_.root, table, !description_.is_v3).empty() ||
                            std::filesystem::exists(description_.root / table, error);
      if (!is_there || episode.length == 0) {
        ++report_.not_carried[is_there ? "episodes without steps"
                                       : "episodes whose files are not there"];
        continue;
      }
      total_ += static_cast<uint64_t>(episode.length);
      episodes_.push_back(std::move(episode));
    }
    description_.episodes.clear();
    if (!missing.empty())
      return not_found("'{}': has no episode '{}'", description_.root.string(), missing.front());
    if (episodes_.empty())
      return not_found("'{}': of its {} episodes no table is there", description_.root.string(),
                       all);
    return {};
  }

  Status add_source(const Feature& feature, size_t number) {
    const Place place = place_of(feature);
    ENGRAM_ASSIGN_OR_RETURN(
        const ltm::MemoryId entity,
        entities_.take(place.memory, place.segment, options_.provider, place.name));
    Source& source = sources_.emplace_back();
    source.feature = feature;
    source.entity = entity;
    source.number = number;
    idf::List names;
    for (const std::string& name : feature.names) names.emplace_back(name);
    idf::Dict attributes{{"dtype", feature.dtype}, {"names", std::move(names)}};
    streams_.push_back({entity, feature.key, total_, std::move(attributes)});
    return {};
  }

  Status begin_episode() {
    const Episode& begun = episodes_[episode_++];
    step_ = 0;
    length_ = begun.length;
    last_task_.reset();
    ENGRAM_RETURN_IF_ERROR(set_start());
    ENGRAM_ASSIGN_OR_RETURN(const bool has_new_columns, rows_.begin(begun));
    if (has_new_columns) task_column_ = rows_.table().find({"task_index"});
    for (Source& source : sources_) {
      if (has_new_columns) find_columns(source);
      source.last_image.reset();
      if (source.feature.kind == Feature::Kind::kVideo)
        ENGRAM_RETURN_IF_ERROR(open_video(source, begun));
    }
    is_inside_ = true;
    return {};
  }

  Status set_start() {
    const Time first = options_.start.value_or(Time{});
    int64_t start = to_ns(first);
    int64_t end = 0;
    const bool is_late =
        (episode_ > 1 &&
         (__builtin_add_overflow(to_ns(last_), options_.episode_gap.count(), &start) ||
          __builtin_add_overflow(start, frame_length().count(), &start))) ||
        __builtin_add_overflow(start, kLongestEpisode.count(), &end);
    if (is_late)
      return invalid_argument("'{}': {} begins behind the year 2255", description_.root.string(),
                              episode().name());
    start_ = time_from_ns(start);
    return {};
  }

  [[nodiscard]] Duration frame_length() const {
    return Duration(static_cast<int64_t>(std::llround(1e9 / description_.rate_hz)));
  }

  Result<Time> time_of_row() {
    ENGRAM_ASSIGN_OR_RETURN(stamp_, rows_.time());
    Time time = start_ + stamp_;
    if (step_ > 0 && time == last_) {
      time += Duration(1);
      ++report_.not_carried["repeated times, moved by 1 ns"];
    }
    if (step_ > 0 && time <= last_)
      return rows_.wrong_time("needs a time behind that of the row before");
    last_ = time;
    return time;
  }

  void find_columns(Source& source) {
    const Feature& feature = source.feature;
    source.columns.clear();
    if (feature.kind == Feature::Kind::kVideo) return;
    if (feature.kind == Feature::Kind::kImage) {
      if (const auto column = rows_.table().find({feature.key})) source.columns = {*column};
    } else {
      source.columns = columns_of(rows_.table(), feature);
    }
    if (source.columns.empty())
      ++report_.not_carried["feature '" + feature.key + "', not in the table of an episode"];
  }

  Status open_video(Source& source, const Episode& begun) {
    source.part = description_.is_v3 ? begun.videos[source.number] : VideoPart();
    ENGRAM_ASSIGN_OR_RETURN(
        const auto path,
        file_in_folder(description_.root,
                       description_.video_of(begun, source.feature, source.number)));
    const Duration from = source.part.from - frame_length() / 2;
    if (description_.is_v3 && source.video && source.video->path() == path &&
        source.video->skip_to(from))
      return {};
    close_video(source);
    ENGRAM_ASSIGN_OR_RETURN(source.video, EpisodeVideo::open(path));
    if (description_.is_v3) source.video->skip_to(from);
    return {};
  }

  void close_video(Source& source) {
    if (!source.video) return;
    report_.damaged += source.video->damaged();
    if (source.video->passed() > 0)
      report_.not_carried["frames without a row"] += source.video->passed();
    if (!source.video->broken().empty()) report_.truncated_at = source.video->broken();
    source.video.reset();
  }

  Status end_episode() {
    is_inside_ = false;
    for (Source& source : sources_) {
      if (!source.video) continue;
      // If episodes share a video, the frame at the end is the first one of the next episode.
      source.video->pass_to(description_.is_v3 ? source.part.to - frame_length() / 2
                                               : Duration::max());
      if (!description_.is_v3 || episode_ == episodes_.size()) close_video(source);
    }
    return rows_.end();
  }

  [[nodiscard]] RecordingEpisode description_of(const Episode& begun, Time time) const {
    idf::List tasks;
    for (const std::string& task : begun.tasks) tasks.emplace_back(task);
    return {"lerobot",
            begun.name(),
            time,
            {{"tasks", std::move(tasks)},
             {"length", begun.length},
             {"robot_type", description_.robot},
             {"fps", description_.rate_hz},
             {"codebase_version", description_.version}}};
  }

  /// Records the current task, of several, when it changes.
  Status add_task(Time time, ltm::Commit& commit) {
    if (tasks_.size() < 2 || !task_column_) return {};
    ENGRAM_ASSIGN_OR_RETURN(const int64_t index, rows_.table().whole(*task_column_));
    if (last_task_ == index) return {};
    last_task_ = index;
    const auto task = tasks_.find(index);
    if (task == tasks_.end())
      return rows_.table().broken(*task_column_, "which the tasks do not have");
    commit.updates.push_back(
        imported(task_entity_, time, idf::Dict{{"text", task->second}, {"task_index", index}}));
    return {};
  }

  Result<std::optional<idf::Data>> value_of(Source& source, Time time) {
    if (source.feature.kind == Feature::Kind::kVideo) return frame_of(source, time);
    if (source.columns.empty()) return std::optional<idf::Data>();
    if (source.feature.kind == Feature::Kind::kImage) return image_of(source, time);
    ENGRAM_ASSIGN_OR_RETURN(auto value, numbers_of(rows_.table(), source.feature, source.columns));
    if (!value) {
      ++report_.not_carried["values with empty cells"];
      return std::optional<idf::Data>();
    }
    if (const Source* camera = first(true))
      value->set(kCamera, camera->entity.at(time).to_string());
    return std::optional<idf::Data>(*std::move(value));
  }

  Result<std::optional<idf::Data>> frame_of(Source& source, Time time) {
    auto image = description_.is_v3
                     ? source.video->at(source.part.from + stamp_, frame_length() / 2)
                     : source.video->next();
    if (image) return picture_of(source, *std::move(image), time);
    ++report_.not_carried["rows without a frame"];
    return std::optional<idf::Data>();
  }

  Result<std::optional<idf::Data>> image_of(Source& source, Time time) {
    if (rows_.table().text(source.columns.front()).empty()) {
      ++report_.not_carried["values with empty cells"];
      return std::optional<idf::Data>();
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto path, rows_.table().file(source.columns.front()));
    auto image = read_image_file(path);
    if (image.ok()) return picture_of(source, *std::move(image), time);
    ++report_.damaged;
    return std::optional<idf::Data>();
  }

  std::optional<idf::Data> picture_of(Source& source, idf::NdArray image, Time time) {
    if (source.last_image && *source.last_image == image) ++report_.duplicate_images;
    source.last_image = image;
    const bool is_depth = image.type() == idf::ElementType::kUInt16;
    idf::Dict value{{is_depth ? "depth" : kImage, std::move(image)}};
    if (const Source* state = first(false)) value.set(kState, state->entity.at(time).to_string());
    return value;
  }

  /// Returns the first camera, or the first observed numbers, or else the first numbers; null if
  /// there are none.
  [[nodiscard]] const Source* first(bool is_picture) const {
    const Source* found = nullptr;
    for (const Source& source : sources_) {
      const bool is_there = source.video || !source.columns.empty();
      if (source.feature.is_picture() != is_picture || !is_there) continue;
      if (source.feature.key.starts_with("observation.")) return &source;
      if (found == nullptr) found = &source;
    }
    return found;
  }

  Description description_;  ///< Without episodes; see `episodes_`.
  const ReadingOptions options_;
  std::vector<Episode> episodes_;  ///< The episodes to read.
  std::vector<Source> sources_;
  std::vector<RecordingStream> streams_;
  FreeEntities entities_;
  std::map<int64_t, std::string> tasks_;
  ltm::MemoryId task_entity_;
  uint64_t total_ = 0;  ///< Number of steps in all episodes.

  size_t episode_ = 0;  ///< The index of the next episode.
  bool is_inside_ = false;
  int64_t step_ = 0;
  int64_t length_ = 0;
  Time start_{};
  Time last_{};
  std::optional<int64_t> last_task_;

  StepRows rows_;
  std::optional<size_t> task_column_;
  Duration stamp_{};  ///< The time of the row in its episode.
};

}  // namespace

Result<std::unique_ptr<RecordingReader>> make_reader(Description description,
                                                     const ReadingOptions& options) {
  auto reader = std::make_unique<Reader>(std::move(description), options);
  ENGRAM_RETURN_IF_ERROR(reader->prepare());
  return std::unique_ptr<RecordingReader>(std::move(reader));
}

}  // namespace engram::datasets::lerobot
