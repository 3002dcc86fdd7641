// SPDX-License-Identifier: Apache-2.0
#include "datasets/video_table.h"

#include <algorithm>
#include <utility>

namespace engram::datasets {

namespace {

constexpr std::string_view kImage = "image";
constexpr std::string_view kState = "state";
constexpr std::string_view kCamera = "camera";

Result<Time> absolute(Time start, Duration offset) {
  int64_t ns = 0;
  if (__builtin_add_overflow(to_ns(start), offset.count(), &ns))
    return invalid_argument("time {} after start {} lies beyond the year 2262", to_string(offset),
                            to_string(start));
  return time_from_ns(ns);
}

/// Returns the one of two times that is nearer to `time`, the earlier one if both are equally near.
/// One of them may be missing.
std::optional<Time> nearer(std::optional<Time> before, std::optional<Time> after, Time time) {
  if (!before || !after) return before ? before : after;
  return *after - time < time - *before ? after : before;
}

idf::NdArray blank_image(const idf::Shape& shape) {
  const auto bytes = idf::size_bytes(idf::ElementType::kUInt8, shape);
  return idf::NdArray::take(shape, std::vector<uint8_t>(bytes.value_or(0)));
}

}  // namespace

Status VideoTable::Options::validate() const {
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

Result<VideoTable::Rows> VideoTable::read_rows(const Options& options, Time start) {
  ENGRAM_ASSIGN_OR_RETURN(Table table, Table::read(options.table, options.table_options));
  const auto is_camera = [](const TableColumn& column) {
    return column.name == kCamera || column.name.starts_with("camera.");
  };
  if (std::ranges::any_of(table.columns(), is_camera))
    return invalid_argument(
        "table '{}': has a column 'camera', needs another name: the link to "
        "the image has this one",
        options.table.string());
  ENGRAM_ASSIGN_OR_RETURN(const Time origin, absolute(start, options.table_offset));
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

Result<std::unique_ptr<RecordingReader>> VideoTable::open(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(VideoReader video,
                          VideoReader::open(options.video, {.width = options.width,
                                                            .height = options.height,
                                                            .crops_square = options.crops_square,
                                                            .threads = options.threads}));
  const Time start = options.start.value_or(video.info().created.value_or(Time{}));
  std::optional<Rows> rows;
  if (!options.table.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(rows, read_rows(options, start));
  }
  std::unique_ptr<VideoTable> reader(
      new VideoTable(options, start, std::move(video), std::move(rows)));
  // The time of the first image is known only after it is decoded.
  ENGRAM_RETURN_IF_ERROR(reader->read_frame());
  if (!reader->frame_)
    return invalid_argument("video '{}': has no frame that can be decoded, needs one or more",
                            options.video.string());
  reader->add_stream(options.entity, options.video, "frames",
                     reader->video_.info().approximate_frames, *reader->frame_time_);
  if (reader->has_row())
    reader->add_stream(options.state_entity, options.table, "rows", reader->rows_->times.size(),
                       reader->rows_->times.front());
  return std::unique_ptr<RecordingReader>(std::move(reader));
}

VideoTable::VideoTable(const Options& options, Time start, VideoReader video,
                       std::optional<Rows> rows)
    : options_(options),
      start_(start),
      video_(std::move(video)),
      blank_(blank_image(video_.image_shape())),
      rows_(std::move(rows)) {}

void VideoTable::add_stream(const ltm::MemoryId& entity, const std::filesystem::path& file,
                            std::string counted_as, uint64_t values, Time first) {
  RecordingStream stream{.entity = entity, .name = file.filename().string(), .values = values};
  stream.counted_as = std::move(counted_as);
  stream.first = first;
  streams_.push_back(std::move(stream));
}

uint64_t VideoTable::total() const {
  const uint64_t frames = video_.info().approximate_frames;
  return frames == 0 ? 0 : frames + (rows_ ? rows_->times.size() : 0);
}

Status VideoTable::read_frame() {
  frame_.reset();
  frame_time_.reset();
  auto decoded = video_.decode();
  report_.damaged = video_.damaged_frames();
  ENGRAM_RETURN_IF_ERROR(decoded.status());
  if (!*decoded) return {};
  ENGRAM_ASSIGN_OR_RETURN(frame_time_, absolute(start_, (*decoded)->time));
  frame_ = *std::move(decoded);
  return {};
}

std::optional<Time> VideoTable::nearest_row(Time time) const {
  if (!rows_) return std::nullopt;
  // All rows before row_ were returned, so they lie before `time`.
  const auto next = rows_->times.begin() + static_cast<std::ptrdiff_t>(row_);
  const auto before = row_ == 0 ? std::nullopt : std::optional(*(next - 1));
  const auto after = next == rows_->times.end() ? std::nullopt : std::optional(*next);
  return nearer(before, after, time);
}

ltm::EntityUpdate VideoTable::update(const ltm::MemoryId& entity, Time time,
                                     idf::Dict value) const {
  const Time now = options_.clock();
  return {entity,
          time,
          {{std::move(value),
            {.created = time, .sent = now, .arrived = now, .provider = options_.provider}}}};
}

/// Converting colours and scaling is most of the work, so an image that nobody takes is never made.
RecordingReader::Moment VideoTable::frame_moment() {
  const Time time = *frame_time_;
  idf::Dict value{{std::string(kImage), blank_}};
  if (const auto row = nearest_row(time))
    value.set(kState, options_.state_entity.at(*row).to_string());
  Moment moment;
  moment.commit.updates.push_back(update(options_.entity, time, std::move(value)));
  moment.unmade =
      UnmadeValue{[this, frame = *frame_](ltm::EntityUpdate& into) -> Status {
                    ENGRAM_ASSIGN_OR_RETURN(idf::NdArray image, video_.convert(frame));
                    into.instances.front().data.get_if<idf::Dict>()->set(kImage, std::move(image));
                    return {};
                  },
                  frame_->bytes()};
  if (last_frame_ && frame_->repeats(*last_frame_)) ++report_.duplicate_images;
  last_frame_ = std::move(frame_);
  last_frame_time_ = time;
  broken_ = read_frame();
  return moment;
}

RecordingReader::Moment VideoTable::row_moment() {
  const Time time = rows_->times[row_];
  idf::Data value = rows_->table.row_value(row_);
  // There is at least one frame, so one of the two is known.
  const auto camera = nearer(last_frame_time_, frame_time_, time);
  value.get_if<idf::Dict>()->set(kCamera, options_.entity.at(*camera).to_string());
  Moment moment;
  moment.commit.updates.push_back(
      update(options_.state_entity, time, std::move(*value.get_if<idf::Dict>())));
  ++row_;
  const bool is_inside = last_frame_time_ && (frame_time_ || time == *last_frame_time_);
  if (!is_inside) ++report_.rows_outside;
  return moment;
}

Result<std::optional<RecordingReader::Moment>> VideoTable::next() {
  ENGRAM_RETURN_IF_ERROR(broken_);
  if (!frame_ && !has_row()) return std::optional<Moment>();
  const bool takes_frame = frame_ && (!has_row() || *frame_time_ <= rows_->times[row_]);
  return std::optional(takes_frame ? frame_moment() : row_moment());
}

}  // namespace engram::datasets
