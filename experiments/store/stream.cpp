// SPDX-License-Identifier: Apache-2.0
#include "store/stream.h"

#include <cmath>

#include "ltm/core/check.h"

namespace engram::experiments {

namespace {

// 2022-02-18 13:06:56 UTC.
constexpr int64_t kStartNs = 1645189616000000000;
constexpr int64_t kTickNs = 1000000000 / Stream::kTicksPerSecond;

Tick::Pose pose(const char* name, double phase) {
  const float c = static_cast<float>(std::cos(phase)), s = static_cast<float>(std::sin(phase));
  return {name, {c, -s, 0, 1 + c, s, c, 0, 2 + s, 0, 0, 1, 0, 0, 0, 0, 1}};
}

ltm::MemoryId id(const std::string& text) {
  return ltm::MemoryId::parse(text).value();
}

idf::Data dict_of(const JointRow& row) {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> made;
    for (size_t i = 0; i < kJoints; ++i) made.push_back(fmt::format("joint_{:02}", i));
    return made;
  }();
  idf::Dict dict;
  dict.reserve(kJoints);
  for (size_t i = 0; i < kJoints; ++i) dict.append_unique(names[i], row[i]);
  return dict;
}

ltm::Snapshot snapshot(ltm::MemoryId entity, Time time, idf::Data data) {
  ltm::InstanceMetadata metadata{time, time, time, "stream", 1.0f};
  return {std::move(entity), time, {{std::move(data), std::move(metadata)}}};
}

ltm::MemoryId pose_id(const std::string& name) {
  return id(name == "platform" ? "RobotState/Localization/robot/platform"
                               : "Scene/Objects/tracker/" + name);
}

}  // namespace

uint64_t Tick::raw_bytes() const {
  uint64_t sum = sizeof(positions) + sizeof(velocities) + text.size();
  for (const idf::NdArray& image : images) sum += image.bytes().size();
  return sum + poses.size() * sizeof(Pose::matrix);
}

Stream::Stream(StreamSource source, double seconds)
    : source_(std::move(source)), ticks_(static_cast<size_t>(seconds * kTicksPerSecond)) {
  ENGRAM_CHECK(source_.frames.size() >= 2, "{} frames", source_.frames.size());
  ENGRAM_CHECK(source_.frames.size() == source_.joints.size(), "{} rows", source_.joints.size());
}

Time Stream::time_of(size_t tick) const {
  return time_from_ns(kStartNs + static_cast<int64_t>(tick) * kTickNs);
}

size_t Stream::tick_at(Time time) const {
  return static_cast<size_t>((to_ns(time) - kStartNs) / kTickNs);
}

size_t Stream::frame_index(size_t camera, size_t tick) const {
  const size_t count = source_.frames.size();
  // The cameras are half the list apart, so that they show different images.
  return (tick / kTicksPerImage + camera * (count / 2)) % count;
}

/// Joints are measured with the frames and interpolated in between.
JointRow Stream::positions_at(size_t tick) const {
  const size_t count = source_.joints.size();
  const JointRow& from = source_.joints[tick / kTicksPerImage % count];
  const JointRow& to = source_.joints[(tick / kTicksPerImage + 1) % count];
  const double share = static_cast<double>(tick % kTicksPerImage) / kTicksPerImage;
  JointRow row{};
  for (size_t i = 0; i < kJoints; ++i) row[i] = from[i] + share * (to[i] - from[i]);
  return row;
}

Tick Stream::tick(size_t index) const {
  Tick made;
  made.time = time_of(index);
  made.positions = positions_at(index);
  const JointRow next = positions_at(index + 1);
  for (size_t i = 0; i < kJoints; ++i)
    made.velocities[i] = (next[i] - made.positions[i]) * kTicksPerSecond;
  const double phase = 0.001 * static_cast<double>(index);
  if (index % kTicksPerImage == 0) {
    for (size_t camera = 0; camera < kCameras.size(); ++camera)
      made.images.push_back(source_.frames[frame_index(camera, index)]);
    made.poses.push_back(pose("platform", phase));
  }
  if (index % 10 == 0)
    for (const char* name : {"bottle", "box", "cup"}) made.poses.push_back(pose(name, 3 * phase));
  if (index % kTicksPerSecond == 0)
    made.text = fmt::format("second {}: pick up the yellow bottle", index / kTicksPerSecond);
  return made;
}

uint64_t Stream::raw_bytes() const {
  uint64_t sum = 0;
  for (size_t i = 0; i < ticks_; ++i) sum += tick(i).raw_bytes();
  return sum;
}

ltm::MemoryId camera_id(size_t camera) {
  return id(fmt::format("Vision/RGB/head/{}", kCameras[camera]));
}

ltm::Commit commit_of(const Tick& tick) {
  static const ltm::MemoryId joints = id("RobotState/Proprioception/robot/joints");
  ltm::Commit commit;
  commit.updates.push_back(snapshot(
      joints, tick.time,
      idf::Dict{{"positions", dict_of(tick.positions)}, {"velocities", dict_of(tick.velocities)}}));
  for (size_t camera = 0; camera < tick.images.size(); ++camera)
    commit.updates.push_back(
        snapshot(camera_id(camera), tick.time, idf::Dict{{"image", tick.images[camera]}}));
  for (const Tick::Pose& it : tick.poses) {
    std::vector<float> matrix(it.matrix.begin(), it.matrix.end());
    commit.updates.push_back(
        snapshot(pose_id(it.name), tick.time,
                 idf::Dict{{"pose", idf::NdArray::take<float>({4, 4}, std::move(matrix))}}));
  }
  if (!tick.text.empty())
    commit.updates.push_back(snapshot(id("Speech/Text/recognizer/utterance"), tick.time,
                                      idf::Dict{{"text", std::string_view(tick.text)}}));
  return commit;
}

}  // namespace engram::experiments
