// SPDX-License-Identifier: Apache-2.0
#include "datasets/video_table.h"

#include <algorithm>
#include <utility>

#include "datasets/media/video_reader.h"
#include "ltm/core/read_ahead.h"

namespace engram::datasets {

namespace {

constexpr std::string_view kImage = "image";
constexpr std::string_view kState = "state";
constexpr std::string_view kCamera = "camera";
constexpr uint64_t kCommitsPerProgress = 8;
constexpr size_t kBytesAhead = 32 << 20;

Result<Time> absolute(Time start, Duration offset) {
  int64_t ns = 0;
  if (__builtin_add_overflow(to_ns(start), offset.count(), &ns))
    return invalid_argument("time {} after start {} lies beyond the year 2262", to_string(offset),
                            to_string(start));
  return time_from_ns(ns);
}

/// The rows of the table with their absolute times.
struct Rows {
  Table table;
  std::vector<Time> times;
};

Result<Rows> read_rows(const VideoTableImport& options) {
  ENGRAM_ASSIGN_OR_RETURN(Table table, Table::read(options.table, options.table_options));
  const auto is_camera = [](const TableColumn& column) {
    return column.name == kCamera || column.name.starts_with("camera.");
  };
  if (std::ranges::any_of(table.columns(), is_camera))
    return invalid_argument(
        "table '{}': has a column 'camera', needs another name: the link to "
        "the image has this one",
        options.table.string());
  ENGRAM_ASSIGN_OR_RETURN(const Time origin, absolute(options.start, options.table_offset));
  std::vector<Time> times;
  times.reserve(table.rows());
  for (const Duration time : table.times()) {
    auto stamp = absolute(origin, time);
    if (!stamp.ok())
      return stamp.status().with_context(fmt::format("table '{}'", options.table.string()));
    times.push_back(*stamp);
  }
  return Rows{std::move(table), std::move(times)};
}

/// Fails where `entity` already has a snapshot at or after the one that would come first.
Status check_is_new(const ltm::Recorder& recorder, const ltm::MemoryId& entity, Time start,
                    Time first) {
  const std::optional<Time> last = recorder.last_time(entity);
  if (!last || *last < first) return {};
  const auto fits = std::chrono::ceil<std::chrono::seconds>(start + (*last - first) + Duration(1));
  return failed_precondition(
      "entity '{}': has a snapshot at {}, the import would begin at {}; needs a start of {} or "
      "later",
      entity.to_string(), to_string(*last), to_string(first), to_string(Time(fits)));
}

/// Whichever of two times is nearer to `time`, the earlier of two as near; one may be missing.
std::optional<Time> nearer(std::optional<Time> before, std::optional<Time> after, Time time) {
  if (!before || !after) return before ? before : after;
  return *after - time < time - *before ? after : before;
}

/// A frame, or the end, and how many were damaged up to there.
struct FrameAhead {
  std::optional<DecodedFrame> frame;
  uint64_t damaged = 0;
};

/// Decodes in a thread of its own.
ReadAhead<FrameAhead> decode_ahead(VideoReader& video) {
  return {[&video, is_ended = false]() mutable -> Result<std::optional<FrameAhead>> {
            if (is_ended) return std::optional<FrameAhead>();
            ENGRAM_ASSIGN_OR_RETURN(auto frame, video.decode());
            is_ended = !frame;
            return std::optional(FrameAhead{std::move(frame), video.damaged_frames()});
          },
          [](const FrameAhead& ahead) { return ahead.frame ? ahead.frame->bytes() : size_t{0}; },
          kBytesAhead};
}

idf::NdArray blank_image(const idf::Shape& shape) {
  const auto bytes = idf::size_bytes(idf::ElementType::kUInt8, shape);
  return idf::NdArray::take(shape, std::vector<uint8_t>(bytes.value_or(0)));
}

/// One run of an import: two streams, merged.
class Import {
 public:
  Import(const VideoTableImport& options, ltm::Recorder& recorder, const ProgressSink& progress,
         VideoReader video, std::optional<Rows> rows)
      : options_(options),
        recorder_(recorder),
        progress_(progress),
        video_(std::move(video)),
        blank_(blank_image(video_.image_shape())),
        rows_(std::move(rows)),
        frames_(decode_ahead(video_)) {}

  Result<ImportReport> run(const std::stop_token& stop);

 private:
  Status read_next();
  Status check_start() const;
  Status merge(const std::stop_token& stop);
  Status commit_frame();
  Status commit_row();
  [[nodiscard]] ltm::EntityUpdate update(const ltm::MemoryId& entity, Time time,
                                         idf::Dict value) const;
  Status commit(ltm::EntityUpdate update);
  void note(Time time);
  void tell(bool is_last) const;
  [[nodiscard]] bool has_row() const { return rows_ && row_ < rows_->times.size(); }
  [[nodiscard]] std::optional<Time> nearest_row(Time time) const;

  const VideoTableImport& options_;
  ltm::Recorder& recorder_;
  const ProgressSink& progress_;
  VideoReader video_;
  const idf::NdArray blank_;  // An image as large as those of the video.
  std::optional<Rows> rows_;
  std::optional<DecodedFrame> frame_;    // The next one, not committed yet.
  std::optional<Time> frame_time_;       // Its time.
  std::optional<Time> last_frame_time_;  // Of the one committed last.
  std::optional<DecodedFrame> last_frame_;
  size_t row_ = 0;
  ImportReport report_;
  ReadAhead<FrameAhead> frames_;  ///< Last: it uses the video.
};

Status Import::read_next() {
  ENGRAM_ASSIGN_OR_RETURN(auto decoded, frames_.next());
  if (decoded) {
    frame_ = std::move(decoded->frame);
    report_.damaged_frames = decoded->damaged;
  }
  frame_time_.reset();
  if (frame_) {
    ENGRAM_ASSIGN_OR_RETURN(frame_time_, absolute(options_.start, frame_->time));
  }
  return {};
}

Status Import::check_start() const {
  if (!frame_)
    return invalid_argument("video '{}': has no frame that can be decoded, needs one or more",
                            options_.video.string());
  ENGRAM_RETURN_IF_ERROR(check_is_new(recorder_, options_.entity, options_.start, *frame_time_));
  if (!rows_) return {};
  return check_is_new(recorder_, options_.state_entity, options_.start, rows_->times.front());
}

std::optional<Time> Import::nearest_row(Time time) const {
  if (!rows_) return std::nullopt;
  // All rows before row_ are committed: they lie before `time`.
  const auto next = rows_->times.begin() + static_cast<std::ptrdiff_t>(row_);
  const auto before = row_ == 0 ? std::nullopt : std::optional(*(next - 1));
  const auto after = next == rows_->times.end() ? std::nullopt : std::optional(*next);
  return nearer(before, after, time);
}

ltm::EntityUpdate Import::update(const ltm::MemoryId& entity, Time time, idf::Dict value) const {
  const Time now = options_.clock();
  return {entity,
          time,
          {{std::move(value),
            {.created = time, .sent = now, .arrived = now, .provider = options_.provider}}}};
}

Status Import::commit(ltm::EntityUpdate update) {
  ltm::Commit commit;
  commit.updates.push_back(std::move(update));
  return recorder_.commit(commit);
}

void Import::note(Time time) {
  if (!report_.first) report_.first = time;
  report_.last = time;
}

/// Images of frames that are dropped for their time are never made.
Status Import::commit_frame() {
  const Time time = *frame_time_;
  idf::Dict value{{std::string(kImage), blank_}};
  if (const auto row = nearest_row(time))
    value.set(kState, options_.state_entity.at(*row).to_string());
  ltm::EntityUpdate made = update(options_.entity, time, std::move(value));
  if (!recorder_.drop_unmade(options_.entity, time, made.raw_bytes())) {
    ENGRAM_ASSIGN_OR_RETURN(idf::NdArray image, video_.convert(*frame_));
    made.instances.front().data.get_if<idf::Dict>()->set(kImage, std::move(image));
    ENGRAM_RETURN_IF_ERROR(commit(std::move(made)));
  }
  note(time);
  ++report_.frames;
  if (last_frame_ && frame_->repeats(*last_frame_)) ++report_.duplicate_frames;
  last_frame_ = std::exchange(frame_, std::nullopt);
  last_frame_time_ = time;
  return read_next();
}

Status Import::commit_row() {
  const Time time = rows_->times[row_];
  idf::Data value = rows_->table.row_value(row_);
  // There is at least one frame, so one of the two is known.
  const auto camera = nearer(last_frame_time_, frame_time_, time);
  value.get_if<idf::Dict>()->set(kCamera, options_.entity.at(*camera).to_string());
  ENGRAM_RETURN_IF_ERROR(
      commit(update(options_.state_entity, time, std::move(*value.get_if<idf::Dict>()))));
  note(time);
  ++report_.rows;
  ++row_;
  const bool is_inside = last_frame_time_ && (frame_time_ || time == *last_frame_time_);
  if (!is_inside) ++report_.rows_outside_video;
  return {};
}

void Import::tell(bool is_last) const {
  const uint64_t done = report_.frames + report_.rows;
  if (!progress_ || (!is_last && done % kCommitsPerProgress != 0)) return;
  const uint64_t frames = frame_ ? video_.info().approximate_frames : report_.frames;
  const uint64_t total = frames == 0 ? 0 : frames + (rows_ ? rows_->times.size() : 0);
  progress_({.what = "import " + options_.entity.to_string(),
             .done = done,
             .total = std::max(total, total == 0 ? 0 : done),
             .detail = fmt::format("{} frames, {} rows", report_.frames, report_.rows)});
}

Status Import::merge(const std::stop_token& stop) {
  while (frame_ || has_row()) {
    if (stop.stop_requested()) {
      report_.is_cancelled = true;
      return {};
    }
    const bool takes_frame = frame_ && (!has_row() || *frame_time_ <= rows_->times[row_]);
    ENGRAM_RETURN_IF_ERROR(takes_frame ? commit_frame() : commit_row());
    tell(false);
  }
  return {};
}

Result<ImportReport> Import::run(const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(read_next());
  ENGRAM_RETURN_IF_ERROR(check_start());
  if (Status status = merge(stop); !status.ok())
    return status.with_context(fmt::format("import stopped after {} frames and {} rows, which stay",
                                           report_.frames, report_.rows));
  tell(true);
  return report_;
}

}  // namespace

Status VideoTableImport::validate() const {
  if (!entity.is_entity())
    return invalid_argument("import: '{}' needs to be an entity, four names", entity.to_string());
  if (!table.empty() && !state_entity.is_entity())
    return invalid_argument("import: state entity '{}' needs to be an entity, four names",
                            state_entity.to_string());
  if (!table.empty() && entity == state_entity)
    return invalid_argument("import: '{}' is both entity and state entity, needs two",
                            entity.to_string());
  if (!clock) return invalid_argument("import: needs a clock");
  return {};
}

Result<ImportReport> import_video_table(const VideoTableImport& options, ltm::Recorder& recorder,
                                        const ProgressSink& progress, std::stop_token stop) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(VideoReader video,
                          VideoReader::open(options.video, {.width = options.width,
                                                            .height = options.height,
                                                            .crops_square = options.crops_square,
                                                            .threads = options.threads}));
  std::optional<Rows> rows;
  if (!options.table.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(rows, read_rows(options));
  }
  return Import(options, recorder, progress, std::move(video), std::move(rows)).run(stop);
}

}  // namespace engram::datasets
