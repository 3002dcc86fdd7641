// SPDX-License-Identifier: Apache-2.0
#include "store/bag_file.h"

#include <geometry_msgs/PoseStamped.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/String.h>

#include <cmath>
#include <utility>

namespace engram::experiments {

namespace {

ros::Time ros_time(int64_t time_ns) {
  ros::Time made;
  made.fromNSec(static_cast<uint64_t>(time_ns));
  return made;
}

rosbag::CompressionType type_of(BagCompression compression) {
  switch (compression) {
    case BagCompression::kNone:
      return rosbag::compression::Uncompressed;
    case BagCompression::kLz4:
      return rosbag::compression::LZ4;
    case BagCompression::kBz2:
      return rosbag::compression::BZ2;
  }
  return rosbag::compression::Uncompressed;
}

/// Runs `act` and converts the exceptions of the library to a status.
template <typename Act>
Status guarded(const Act& act) {
  try {
    act();
    return {};
  } catch (const std::exception& error) {
    return unavailable("rosbag: {}", error.what());
  }
}

}  // namespace

struct BagFile::State {
  template <typename Message>
  using Messages = std::vector<std::pair<std::string, Message>>;

  rosbag::Bag bag;
  ros::Time time;
  Messages<sensor_msgs::JointState> joints;
  Messages<sensor_msgs::Image> images;
  Messages<geometry_msgs::PoseStamped> poses;
  Messages<std_msgs::String> texts;

  template <typename Message>
  void write(const Messages<Message>& messages) {
    for (const auto& [topic, message] : messages) bag.write(topic, time, message);
  }
};

BagFile::BagFile() : state_(std::make_unique<State>()) {}
BagFile::~BagFile() = default;

Status BagFile::create(const std::string& path, BagCompression compression) {
  return guarded([&] {
    state_->bag.open(path, rosbag::bagmode::Write);
    state_->bag.setCompression(type_of(compression));
  });
}

Status BagFile::open(const std::string& path) {
  return guarded([&] { state_->bag.open(path, rosbag::bagmode::Read); });
}

Status BagFile::close() {
  return guarded([&] { state_->bag.close(); });
}

void BagFile::begin(int64_t time_ns) {
  state_->time = ros_time(time_ns);
  state_->joints.clear();
  state_->images.clear();
  state_->poses.clear();
  state_->texts.clear();
}

void BagFile::put_joints(const double* positions, const double* velocities, size_t count) {
  sensor_msgs::JointState message;
  message.header.stamp = state_->time;
  for (size_t i = 0; i < count; ++i) message.name.push_back(fmt::format("joint_{:02}", i));
  message.position.assign(positions, positions + count);
  message.velocity.assign(velocities, velocities + count);
  state_->joints.emplace_back("/joints", std::move(message));
}

void BagFile::put_image(const std::string& topic, const uint8_t* pixels, uint32_t width,
                        uint32_t height) {
  sensor_msgs::Image message;
  message.header.stamp = state_->time;
  message.header.frame_id = topic;
  message.width = width;
  message.height = height;
  message.encoding = "rgb8";
  message.step = 3 * width;
  message.data.assign(pixels, pixels + size_t{3} * width * height);
  state_->images.emplace_back(topic, std::move(message));
}

void BagFile::put_pose(const std::string& topic, double x, double y, double angle) {
  geometry_msgs::PoseStamped message;
  message.header.stamp = state_->time;
  message.pose.position.x = x;
  message.pose.position.y = y;
  message.pose.orientation.z = std::sin(angle / 2);
  message.pose.orientation.w = std::cos(angle / 2);
  state_->poses.emplace_back(topic, std::move(message));
}

void BagFile::put_text(const std::string& text) {
  std_msgs::String message;
  message.data = text;
  state_->texts.emplace_back("/text", std::move(message));
}

Status BagFile::write() {
  return guarded([&] {
    state_->write(state_->joints);
    state_->write(state_->images);
    state_->write(state_->poses);
    state_->write(state_->texts);
  });
}

Result<std::shared_ptr<const std::vector<uint8_t>>> BagFile::image(const std::string& topic,
                                                                   int64_t time_ns) {
  sensor_msgs::Image::ConstPtr found;
  const Status status = guarded([&] {
    const ros::Time at = ros_time(time_ns);
    rosbag::View view(state_->bag, rosbag::TopicQuery(topic), at, at);
    if (view.begin() != view.end()) found = view.begin()->instantiate<sensor_msgs::Image>();
  });
  if (!status.ok()) return status;
  if (!found) return not_found("bag: topic '{}' has no image at {} ns", topic, time_ns);
  // The pointer shares the message, so the pixels are not copied within the timing.
  return std::shared_ptr<const std::vector<uint8_t>>(&found->data, [found](const void*) {});
}

}  // namespace engram::experiments
