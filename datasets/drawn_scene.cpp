// SPDX-License-Identifier: Apache-2.0
#include "datasets/drawn_scene.h"

#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "datasets/media/video_writer.h"
#include "datasets/scene_painter.h"
#include "datasets/scene_plan.h"
#include "ltm/core/file.h"

namespace engram::datasets {

namespace {

constexpr int kMinSide = 32;
constexpr int kMaxSide = 1024;
constexpr double kMaxSeconds = 3600;
constexpr int kMaxRate = 240;
constexpr double kMaxNoise = 32;
constexpr int64_t kNsPerSecond = 1'000'000'000;
constexpr uint64_t kFramesPerProgress = 16;

/// Returns the time of a frame, rounded to the nearest nanosecond.
Duration frame_time(uint64_t index, int rate_hz) {
  return Duration((static_cast<int64_t>(index) * kNsPerSecond + rate_hz / 2) / rate_hz);
}

void append_row(std::string& text, const SceneFrame& frame) {
  const int64_t ns = frame.time.count();
  const ArmState& arm = frame.arm;
  text += fmt::format("{}.{:09},{},{},{},{},{}\n", ns / kNsPerSecond, ns % kNsPerSecond,
                      arm.shoulder_rad, arm.elbow_rad, arm.gripper, arm.shoulder_velocity_rad_s,
                      arm.elbow_velocity_rad_s);
}

bool is_side(int pixels) {
  return pixels >= kMinSide && pixels <= kMaxSide && pixels % 2 == 0;
}

}  // namespace

Status SceneOptions::validate() const {
  if (!is_side(width) || !is_side(height))
    return invalid_argument("scene: size {} x {}, needs even numbers of {} to {}", width, height,
                            kMinSide, kMaxSide);
  if (rate_hz < 1 || rate_hz > kMaxRate)
    return invalid_argument("scene: {} frames per second, needs 1 to {}", rate_hz, kMaxRate);
  if (!(seconds * rate_hz >= 1) || seconds > kMaxSeconds)
    return invalid_argument("scene: {} seconds, needs a frame at least and {} s at most", seconds,
                            kMaxSeconds);
  if (!(noise_sigma >= 0) || noise_sigma > kMaxNoise)
    return invalid_argument("scene: noise of {} grey levels, needs 0 to {}", noise_sigma,
                            kMaxNoise);
  return {};
}

struct Scene::State {
  explicit State(const SceneOptions& chosen)
      : options(chosen), plan(chosen.seed, chosen.seconds), painter(chosen) {}

  SceneOptions options;
  scene::Plan plan;
  scene::Painter painter;
};

Scene::Scene(std::unique_ptr<const State> state) : state_(std::move(state)) {}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

Result<Scene> Scene::create(const SceneOptions& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  try {
    return Scene(std::make_unique<const State>(options));
  } catch (const cv::Exception& error) {
    return resource_exhausted("scene: cannot draw the room: {}", error.what());
  }
}

uint64_t Scene::frames() const {
  return static_cast<uint64_t>(std::llround(state_->options.seconds * state_->options.rate_hz));
}

Result<SceneFrame> Scene::render(uint64_t index) const {
  ENGRAM_CHECK(index < frames(), "frame {} of {}", index, frames());
  const SceneOptions& options = state_->options;
  const Duration time = frame_time(index, options.rate_hz);
  const scene::Moment moment = state_->plan.at(to_seconds(time));
  std::vector<uint8_t> pixels(static_cast<size_t>(options.width) *
                              static_cast<size_t>(options.height) * 3);
  cv::Mat image(options.height, options.width, CV_8UC3, pixels.data());
  try {
    state_->painter.paint(moment, index, image);
  } catch (const cv::Exception& error) {
    return resource_exhausted("scene: cannot draw frame {}: {}", index, error.what());
  }
  return SceneFrame{time, idf::NdArray::take({options.height, options.width, 3}, std::move(pixels)),
                    moment.arm};
}

Status write_scene(const SceneOptions& options, const std::filesystem::path& video,
                   const std::filesystem::path& table, const ProgressSink& progress) {
  ENGRAM_ASSIGN_OR_RETURN(const Scene scene, Scene::create(options));
  ENGRAM_ASSIGN_OR_RETURN(VideoWriter writer,
                          VideoWriter::create(video, {.width = options.width,
                                                      .height = options.height,
                                                      .rate_numerator = options.rate_hz,
                                                      .crf = options.crf}));
  std::string rows =
      "timestamp,joint.shoulder,joint.elbow,joint.gripper,velocity.shoulder,velocity.elbow\n";
  for (uint64_t i = 0; i < scene.frames(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const SceneFrame frame, scene.render(i));
    ENGRAM_RETURN_IF_ERROR(writer.write(frame.image));
    append_row(rows, frame);
    if (progress && ((i + 1) % kFramesPerProgress == 0 || i + 1 == scene.frames()))
      progress(
          {.what = "render " + video.filename().string(), .done = i + 1, .total = scene.frames()});
  }
  ENGRAM_RETURN_IF_ERROR(writer.close());
  // The table is written last, so an interrupted call leaves no table without its video.
  return replace_file(std::filesystem::absolute(table), as_bytes(rows));
}

}  // namespace engram::datasets
