// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/episode_video.h"

#include <utility>

namespace engram::datasets::lerobot {

Result<EpisodeVideo> EpisodeVideo::open(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(VideoReader reader, VideoReader::open(path, {}));
  return EpisodeVideo(path, std::move(reader));
}

bool EpisodeVideo::fetch() {
  if (frame_ || is_over_) return frame_.has_value();
  auto frame = reader_.decode();
  if (!frame.ok()) broken_ = frame.status().message();
  is_over_ = !frame.ok() || !*frame;
  if (!is_over_) frame_ = **std::move(frame);
  return frame_.has_value();
}

bool EpisodeVideo::skip_to(Duration time) {
  if (reached_ >= time) return false;
  for (; fetch() && frame_->time < time; frame_.reset()) reached_ = frame_->time;
  return true;
}

std::optional<idf::NdArray> EpisodeVideo::next() {
  if (!fetch()) return std::nullopt;
  reached_ = frame_->time;
  auto image = reader_.convert(*std::exchange(frame_, std::nullopt));
  if (image.ok()) return *std::move(image);
  broken_ = image.status().message();
  is_over_ = true;
  return std::nullopt;
}

std::optional<idf::NdArray> EpisodeVideo::at(Duration time, Duration tolerance) {
  pass_to(time - tolerance);
  if (!fetch() || frame_->time >= time + tolerance) return std::nullopt;
  return next();
}

void EpisodeVideo::pass_to(Duration time) {
  for (; fetch() && frame_->time < time; frame_.reset()) {
    reached_ = frame_->time;
    ++passed_;
  }
}

}  // namespace engram::datasets::lerobot
