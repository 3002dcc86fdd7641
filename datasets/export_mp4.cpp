// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "datasets/export_formats.h"
#include "datasets/export_images.h"
#include "datasets/export_names.h"
#include "datasets/media/video_writer.h"
#include "ltm/core/file.h"

namespace engram::datasets {

namespace {

/// A longer gap starts another video, because nobody waits that long in a player.
constexpr Duration kMaxGap = std::chrono::hours(1);
/// Rates are written as fractions that are exact to a thousandth.
constexpr int kRateDenominator = 1000;
/// The nominal rate of a video whose images have their own times.
constexpr int kUsualRate = 30;
/// Each open video has an encoder, which keeps several pictures in memory.
constexpr size_t kMaxOpenVideos = 32;
/// Unit: pixels.
constexpr int64_t kMaxVideoSide = 1 << 14;

/// Converts an image for a video: three channels, and even sides unless colour is kept at full
/// resolution. The last line or column is repeated to make a side even.
idf::NdArray as_picture(const idf::NdArray& image, bool keeps_chroma) {
  const auto height = static_cast<size_t>(image.shape()[0]);
  const auto width = static_cast<size_t>(image.shape()[1]);
  const auto channels = static_cast<size_t>(image.shape()[2]);
  const size_t rows = keeps_chroma ? height : (height + 1) / 2 * 2;
  const size_t columns = keeps_chroma ? width : (width + 1) / 2 * 2;
  if (channels == 3 && rows == height && columns == width) return image;
  const auto from = image.values<uint8_t>();
  std::vector<uint8_t> pixels(rows * columns * 3);
  for (size_t y = 0; y < rows; ++y)
    for (size_t x = 0; x < columns; ++x)
      for (size_t c = 0; c < 3; ++c)
        pixels[(y * columns + x) * 3 + c] =
            from[(std::min(y, height - 1) * width + std::min(x, width - 1)) * channels +
                 std::min(c, channels - 1)];
  return idf::NdArray::take({static_cast<int64_t>(rows), static_cast<int64_t>(columns), 3},
                            std::move(pixels));
}

/// A video that is being written.
struct Video {
  VideoWriter writer;
  std::filesystem::path path;
  idf::Shape shape;
  Time first{};
  Time last{};
};

/// Writes <entity>/<member>.mp4; further instances go to <member>#1.mp4. Another image size, or a
/// gap, starts the next part: <member>.part2.mp4.
class Mp4Sink : public SnapshotSink {
 public:
  Mp4Sink(std::filesystem::path directory, const ExportOptions& options)
      : directory_(std::move(directory)), options_(options) {}

  Status begin(const ltm::MemoryId& entity) override {
    ENGRAM_RETURN_IF_ERROR(close_all());
    parts_.clear();
    folder_ = directory_ / export_folder(entity);
    return {};
  }

  Status add(const ltm::SnapshotResult& snapshot) override {
    return for_each_image(snapshot, report_, [&](int32_t index, const ImageMember& member) {
      return write(snapshot.time, index, member);
    });
  }

  Status finish() override { return close_all(); }

 private:
  Status write(Time time, int32_t index, const ImageMember& member) {
    if (member.image.type() != idf::ElementType::kUInt8) return leave_out("images of 16 bits");
    if (std::max(member.image.shape()[0], member.image.shape()[1]) > kMaxVideoSide)
      return leave_out("images of more than 16384 pixels to a side");
    const idf::NdArray picture = as_picture(member.image, options_.keeps_chroma);
    if (picture.shape()[0] != member.image.shape()[0] ||
        picture.shape()[1] != member.image.shape()[1])
      ++report_.not_carried["odd sizes (the last line or column is there twice)"];
    const std::string name =
        export_member(member.path) + (index == 0 ? "" : fmt::format("#{}", index));
    if (videos_.size() >= kMaxOpenVideos && !videos_.contains(name))
      return leave_out("images beside 32 others of the same entity");
    ENGRAM_ASSIGN_OR_RETURN(Video * video, video_of(name, time, picture.shape()));
    video->last = time;
    return options_.rate_hz > 0 ? video->writer.write(picture)
                                : video->writer.write(picture, time - video->first);
  }

  Status leave_out(std::string_view what) {
    ++report_.not_carried[std::string(what)];
    return {};
  }

  Result<Video*> video_of(const std::string& name, Time time, const idf::Shape& shape) {
    if (const auto known = videos_.find(name); known != videos_.end()) {
      Video& video = known->second;
      if (video.shape == shape && time - video.last <= kMaxGap) return &video;
      ENGRAM_RETURN_IF_ERROR(close(video));
      videos_.erase(known);
    }
    const int part = ++parts_[name];
    const auto path = folder_ / (name + (part == 1 ? "" : fmt::format(".part{}", part)) + ".mp4");
    ENGRAM_RETURN_IF_ERROR(make_directories(folder_));
    ENGRAM_ASSIGN_OR_RETURN(VideoWriter writer,
                            VideoWriter::create(path, writer_options(time, shape)));
    return &videos_.emplace(name, Video{std::move(writer), path, shape, time, time}).first->second;
  }

  [[nodiscard]] VideoWriter::Options writer_options(Time time, const idf::Shape& shape) const {
    VideoWriter::Options options{.width = static_cast<int>(shape[1]),
                                 .height = static_cast<int>(shape[0]),
                                 .rate_numerator = kUsualRate,
                                 .crf = options_.crf,
                                 .keeps_chroma = options_.keeps_chroma,
                                 .has_times = options_.rate_hz == 0,
                                 .created = time};
    if (options_.rate_hz == 0) return options;
    options.rate_numerator = static_cast<int>(std::lround(options_.rate_hz * kRateDenominator));
    options.rate_denominator = kRateDenominator;
    return options;
  }

  Status close(Video& video) {
    ENGRAM_RETURN_IF_ERROR(video.writer.close());
    ++report_.files;
    std::error_code error;
    const uintmax_t bytes = std::filesystem::file_size(video.path, error);
    if (error) return unavailable("'{}': {}", video.path.string(), error.message());
    report_.bytes += bytes;
    return {};
  }

  Status close_all() {
    for (auto& [name, video] : videos_) ENGRAM_RETURN_IF_ERROR(close(video));
    videos_.clear();
    return {};
  }

  std::filesystem::path directory_;
  ExportOptions options_;
  std::filesystem::path folder_;
  std::map<std::string, Video> videos_;  ///< Open videos of the current entity, by name.
  std::map<std::string, int> parts_;     ///< Number of parts that were started, by name.
};

}  // namespace

std::unique_ptr<SnapshotSink> make_mp4_sink(const std::filesystem::path& directory,
                                            const ExportOptions& options) {
  return std::make_unique<Mp4Sink>(directory, options);
}

}  // namespace engram::datasets
