// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/lerobot_reader.h"

#include <algorithm>
#include <cmath>

#include "datasets/lerobot/lerobot_table.h"
#include "datasets/media/video_reader.h"

namespace engram::datasets::lerobot {

namespace {

constexpr const char* kImage = "image";
constexpr const char* kState = "state";
constexpr const char* kCamera = "camera";

/// What tables have beside features of the robot.
bool is_bookkeeping(const std::string& key) {
  static const std::vector<std::string> keys{"timestamp", "frame_index", "episode_index", "index",
                                             "task_index"};
  return std::ranges::find(keys, key) != keys.end();
}

std::string last_part(const std::string& key) {
  return key.substr(key.rfind('.') == std::string::npos ? 0 : key.rfind('.') + 1);
}

std::string without(const std::string& key, std::string_view prefix) {
  return key.starts_with(prefix) ? key.substr(prefix.size()) : key;
}

/// Where values of a feature go.
Result<ltm::MemoryId> entity_of(const Feature& feature, const std::string& provider) {
  const std::string& key = feature.key;
  if (feature.is_video())
    return ltm::MemoryId::from_names({"Vision", "RGB", provider, last_part(key)});
  if (key.starts_with("observation."))
    return ltm::MemoryId::from_names(
        {"RobotState", "Proprioception", provider, without(key, "observation.")});
  if (key.starts_with("action"))
    return ltm::MemoryId::from_names({"Skills", "Commands", provider, key});
  return ltm::MemoryId::from_names({"Tasks", "Feedback", provider, without(key, "next.")});
}

/// A feature, its entity, and what of the episode at hand holds it.
struct Source {
  Feature feature;
  ltm::MemoryId entity;
  std::optional<VideoReader> video;
  std::vector<const TableColumn*> columns;  ///< One for each number.
  std::optional<idf::NdArray> last_image;
};

class Reader final : public RecordingReader {
 public:
  Reader(Description description, const ReadingOptions& options)
      : description_(std::move(description)), options_(options) {}

  Status prepare() {
    ENGRAM_RETURN_IF_ERROR(choose_episodes());
    for (const Feature& feature : description_.features) {
      if (is_bookkeeping(feature.key)) continue;
      if (!feature.is_video() && feature.count == 0) {
        report_.not_carried["features of kind '" + feature.dtype + "'"] += 1;
        continue;
      }
      ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, entity_of(feature, options_.provider));
      sources_.push_back({feature, entity, {}, {}, {}});
      idf::List names;
      for (const std::string& name : feature.names) names.emplace_back(name);
      idf::Dict attributes{{"dtype", feature.dtype}, {"names", std::move(names)}};
      streams_.push_back({entity, feature.key, total_, std::move(attributes)});
    }
    return {};
  }

  [[nodiscard]] const std::vector<RecordingStream>& streams() const override { return streams_; }
  [[nodiscard]] uint64_t total() const override { return total_ * sources_.size(); }

  Result<std::optional<Moment>> next() override {
    while (!table_ || row_ >= table_->rows()) {
      if (table_) end_episode();
      if (episode_ >= episodes_.size()) return std::optional<Moment>();
      ENGRAM_RETURN_IF_ERROR(begin_episode(episodes_[episode_++]));
    }
    Moment moment;
    const Time time = time_of(row_);
    if (row_ == 0) moment.begins = description_of(episodes_[episode_ - 1], time);
    for (Source& source : sources_) {
      ENGRAM_ASSIGN_OR_RETURN(auto value, value_of(source, time));
      if (!value) continue;
      ltm::InstanceMetadata metadata{
          .created = time, .sent = time, .arrived = time, .provider = "import"};
      moment.commit.updates.push_back(
          {source.entity, time, {{*std::move(value), std::move(metadata)}}});
    }
    ++row_;
    return std::optional(std::move(moment));
  }

 private:
  Status choose_episodes() {
    std::vector<std::string> missing = options_.episodes;
    for (const Episode& episode : description_.episodes) {
      const auto asked = [&](const std::string& name) {
        return name == episode.name() || name == std::to_string(episode.index);
      };
      if (!options_.episodes.empty() && std::ranges::none_of(options_.episodes, asked)) continue;
      std::erase_if(missing, asked);
      std::error_code error;
      const std::filesystem::path table = description_.table_of(episode);
      if (csv_of(description_.root, table).empty() && !std::filesystem::exists(table, error)) {
        ++report_.not_carried["episodes whose files are not there"];
        continue;
      }
      episodes_.push_back(episode);
      total_ += static_cast<uint64_t>(episode.length);
    }
    if (!missing.empty())
      return not_found("'{}': has no episode '{}'", description_.root.string(), missing.front());
    if (episodes_.empty())
      return not_found("'{}': of its {} episodes no table is there", description_.root.string(),
                       description_.episodes.size());
    return {};
  }

  Status begin_episode(const Episode& episode) {
    row_ = 0;
    const std::filesystem::path parquet = description_.table_of(episode);
    ENGRAM_ASSIGN_OR_RETURN(table_, read_table(description_.root, parquet));
    if (table_->rows() != static_cast<size_t>(episode.length))
      return data_loss("'{}': found {} rows, needs {} as meta/episodes.jsonl says",
                       parquet.string(), table_->rows(), episode.length);
    start_ =
        episode_ == 1 ? options_.start.value_or(Time{}) : start_ + length_ + options_.episode_gap;
    length_ = table_->times().back() +
              Duration(static_cast<int64_t>(std::llround(1e9 / description_.rate_hz)));
    for (Source& source : sources_) {
      source.last_image.reset();
      if (source.feature.is_video()) {
        const std::filesystem::path path = description_.video_of(episode, source.feature);
        ENGRAM_ASSIGN_OR_RETURN(source.video, VideoReader::open(path, {}));
      } else {
        ENGRAM_RETURN_IF_ERROR(find_columns(source));
      }
    }
    return {};
  }

  /// Tables call number i of feature "observation.state": it and the name or number of the element,
  /// or only "state" and these.
  Status find_columns(Source& source) {
    const Feature& feature = source.feature;
    source.columns.clear();
    for (size_t i = 0; i < feature.count; ++i) {
      std::vector<std::string> names;
      for (const std::string& key : {feature.key, last_part(feature.key)}) {
        if (!feature.names.empty()) names.push_back(key + "." + feature.names[i]);
        names.push_back(key + "." + std::to_string(i));
        if (feature.count == 1) names.push_back(key);
      }
      const auto column = std::ranges::find_if(table_->columns(), [&](const TableColumn& one) {
        return std::ranges::find(names, one.name) != names.end();
      });
      if (column == table_->columns().end()) {
        source.columns.clear();
        ++report_.not_carried["feature '" + feature.key + "', not in the table of an episode"];
        return {};
      }
      source.columns.push_back(&*column);
    }
    return {};
  }

  void end_episode() {
    for (Source& source : sources_) {
      if (!source.video) continue;
      while (true) {
        const auto more = source.video->next();
        if (!more.ok() || !*more) break;
        ++report_.not_carried["frames behind the last row"];
      }
      report_.damaged += source.video->damaged_frames();
      source.video.reset();
    }
    table_.reset();
  }

  [[nodiscard]] Time time_of(size_t row) const { return start_ + table_->times()[row]; }

  [[nodiscard]] RecordingEpisode description_of(const Episode& episode, Time time) const {
    idf::List tasks;
    for (const std::string& task : episode.tasks) tasks.emplace_back(task);
    return {"lerobot",
            episode.name(),
            time,
            {{"tasks", std::move(tasks)},
             {"length", episode.length},
             {"robot_type", description_.robot},
             {"fps", description_.rate_hz},
             {"codebase_version", description_.version}}};
  }

  Result<std::optional<idf::Data>> value_of(Source& source, Time time) {
    if (source.feature.is_video()) return frame_of(source, time);
    if (source.columns.empty()) return std::optional<idf::Data>();
    idf::Dict value;
    if (source.feature.names.empty()) {
      std::vector<double> numbers;
      for (const TableColumn* column : source.columns) numbers.push_back(column->values[row_]);
      const auto count = static_cast<int64_t>(numbers.size());
      value.set("values", idf::NdArray::take<double>({count}, std::move(numbers)));
    } else {
      for (size_t i = 0; i < source.columns.size(); ++i)
        value.set(source.feature.names[i], source.columns[i]->values[row_]);
    }
    if (const Source* camera = first(true)) value.set(kCamera, camera->entity.at(time).to_string());
    return std::optional<idf::Data>(std::move(value));
  }

  Result<std::optional<idf::Data>> frame_of(Source& source, Time time) {
    ENGRAM_ASSIGN_OR_RETURN(auto frame, source.video->next());
    if (!frame) {
      ++report_.not_carried["rows behind the last frame"];
      return std::optional<idf::Data>();
    }
    if (source.last_image && *source.last_image == frame->image) ++report_.duplicate_images;
    source.last_image = frame->image;
    idf::Dict value{{kImage, std::move(frame->image)}};
    if (const Source* state = first(false)) value.set(kState, state->entity.at(time).to_string());
    return std::optional<idf::Data>(std::move(value));
  }

  /// The first camera, or the first numbers that were observed, else the first ones; null where
  /// there are none.
  [[nodiscard]] const Source* first(bool is_video) const {
    const Source* found = nullptr;
    for (const Source& source : sources_) {
      if (source.feature.is_video() != is_video || (!is_video && source.columns.empty())) continue;
      if (source.feature.key.starts_with("observation.")) return &source;
      if (found == nullptr) found = &source;
    }
    return found;
  }

  const Description description_;
  const ReadingOptions options_;
  std::vector<Episode> episodes_;
  std::vector<Source> sources_;
  std::vector<RecordingStream> streams_;
  uint64_t total_ = 0;  ///< Steps of all episodes.
  size_t episode_ = 0;  ///< The next one.
  std::optional<Table> table_;
  size_t row_ = 0;
  Time start_{};
  Duration length_{};
};

}  // namespace

Result<std::unique_ptr<RecordingReader>> make_reader(Description description,
                                                     const ReadingOptions& options) {
  auto reader = std::make_unique<Reader>(std::move(description), options);
  ENGRAM_RETURN_IF_ERROR(reader->prepare());
  return std::unique_ptr<RecordingReader>(std::move(reader));
}

}  // namespace engram::datasets::lerobot
