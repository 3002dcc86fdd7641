// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/message_type.h"

#include <algorithm>
#include <array>

#include "datasets/ros/image_message.h"
#include "datasets/ros/message_coding.h"

namespace engram::datasets::ros {

namespace {

struct TypeSegment {
  std::string_view type;  ///< A whole package if it ends in '/'.
  std::string_view memory;
  std::string_view segment;
};
// The first entry that matches is used.
constexpr std::array<TypeSegment, 26> kSegments{{
    {"sensor_msgs/JointState", "RobotState", "Proprioception"},
    {"sensor_msgs/MultiDOFJointState", "RobotState", "Proprioception"},
    {"sensor_msgs/Imu", "RobotState", "Proprioception"},
    {"sensor_msgs/MagneticField", "RobotState", "Proprioception"},
    {"sensor_msgs/BatteryState", "RobotState", "Proprioception"},
    {"geometry_msgs/Wrench", "RobotState", "Proprioception"},
    {"geometry_msgs/WrenchStamped", "RobotState", "Proprioception"},
    {"control_msgs/JointTrajectoryControllerState", "RobotState", "Proprioception"},
    {"sensor_msgs/Joy", "Skills", "Commands"},
    {"geometry_msgs/Twist", "Skills", "Commands"},
    {"geometry_msgs/TwistStamped", "Skills", "Commands"},
    {"trajectory_msgs/", "Skills", "Commands"},
    {"control_msgs/", "Skills", "Commands"},
    {"ackermann_msgs/", "Skills", "Commands"},
    {"tf2_msgs/TFMessage", "RobotState", "Localization"},
    {"tf/tfMessage", "RobotState", "Localization"},
    {"nav_msgs/Odometry", "RobotState", "Localization"},
    {"sensor_msgs/NavSatFix", "RobotState", "Localization"},
    {"geometry_msgs/Pose", "RobotState", "Localization"},
    {"geometry_msgs/PoseStamped", "RobotState", "Localization"},
    {"geometry_msgs/PoseWithCovariance", "RobotState", "Localization"},
    {"geometry_msgs/PoseWithCovarianceStamped", "RobotState", "Localization"},
    {"geometry_msgs/Transform", "RobotState", "Localization"},
    {"geometry_msgs/TransformStamped", "RobotState", "Localization"},
    {"geometry_msgs/Point", "RobotState", "Localization"},
    {"geometry_msgs/PointStamped", "RobotState", "Localization"},
}};

/// Returns an empty value for a field; None for messages nested deeper than `depth`.
idf::Data empty_value(const MessageDefinition& definition, const Field& field, int depth = 2) {
  if (field.kind == FieldKind::kString) return "";
  if (field.kind == FieldKind::kTime || field.kind == FieldKind::kDuration)
    return idf::Dict{{"sec", int64_t{0}}, {"nsec", int64_t{0}}};
  if (field.kind != FieldKind::kMessage) return int64_t{0};
  if (depth == 0) return {};
  idf::Dict value;
  for (const Field& inner : definition.message(field.message).fields)
    value.append_unique(inner.name, empty_value(definition, inner, depth - 1));
  return value;
}

std::optional<int64_t> whole_at(const idf::Data& value, std::string_view path) {
  const idf::Data* found = value.at(path);
  if (found == nullptr) return std::nullopt;
  if (const auto* number = found->get_if<int64_t>()) return *number;
  if (const auto* number = found->get_if<int32_t>()) return *number;
  return std::nullopt;
}

std::optional<Time> stamp_at(const idf::Data& value, std::string_view path) {
  const idf::Data* stamp = value.at(path);
  if (stamp == nullptr) return std::nullopt;
  const auto seconds = whole_at(*stamp, "sec");
  auto nanoseconds = whole_at(*stamp, "nanosec");
  if (!nanoseconds) nanoseconds = whole_at(*stamp, "nsec");
  // The product cannot overflow, because both have at most 32 bits.
  if (!seconds || !nanoseconds || std::abs(*seconds) > int64_t{1} << 32 || *nanoseconds < 0 ||
      *nanoseconds > int64_t{1} << 32 || (*seconds == 0 && *nanoseconds == 0))
    return std::nullopt;
  return time_from_ns(*seconds * 1'000'000'000 + *nanoseconds);
}

struct NeededField {
  std::string_view name;
  FieldKind kind;
  Multiplicity multiplicity = Multiplicity::kOne;
};
constexpr std::array<NeededField, 7> kImageFields{{
    {"header", FieldKind::kMessage},
    {"height", FieldKind::kUInt32},
    {"width", FieldKind::kUInt32},
    {"encoding", FieldKind::kString},
    {"is_bigendian", FieldKind::kUInt8},
    {"step", FieldKind::kUInt32},
    {"data", FieldKind::kUInt8, Multiplicity::kSequence},
}};
constexpr std::array<NeededField, 3> kCompressedFields{{
    {"header", FieldKind::kMessage},
    {"format", FieldKind::kString},
    {"data", FieldKind::kUInt8, Multiplicity::kSequence},
}};

/// Returns true if a message has the fields that its name promises. Only then nothing is lost when
/// it becomes a picture.
bool has_fields(const Message& message, std::span<const NeededField> needed) {
  return std::ranges::equal(message.fields, needed, [](const Field& a, const NeededField& b) {
    return a.name == b.name && a.kind == b.kind && a.multiplicity == b.multiplicity;
  });
}

}  // namespace

MessageType::MessageType(MessageDefinition definition, Serialization serialization)
    : definition_(std::move(definition)),
      serialization_(serialization),
      is_image_(name() == "sensor_msgs/Image" && has_fields(definition_.root(), kImageFields)),
      is_compressed_(name() == "sensor_msgs/CompressedImage" &&
                     has_fields(definition_.root(), kCompressedFields)) {}

Result<MessageType> MessageType::create(std::string_view type, std::string_view definition,
                                        Serialization serialization) {
  ENGRAM_ASSIGN_OR_RETURN(auto parsed, MessageDefinition::parse(type, definition));
  return MessageType(std::move(parsed), serialization);
}

Result<idf::Data> MessageType::decode(std::span<const std::byte> bytes) const {
  auto value = decode_fields(definition_, serialization_, bytes);
  if (!value.ok()) return value.status().with_context(name());
  if (is_image_) return picture_of_image(*std::move(value));
  if (is_compressed_) return picture_of_compressed(*std::move(value));
  return value;
}

Result<std::vector<std::byte>> MessageType::encode(const idf::Data& value, int jpeg_quality) const {
  Result<idf::Data> message = value;
  if (is_image_) message = image_of_picture(value);
  if (is_compressed_) message = compressed_of_picture(value, jpeg_quality);
  if (!message.ok()) return message.status().with_context(name());
  if (auto* fields = message->get_if<idf::Dict>()) {
    const idf::Data* header = fields->find("header");
    if (header == nullptr || header->is<idf::None>())
      if (idf::Data empty = empty_header(); !empty.is<idf::None>())
        fields->set("header", std::move(empty));
  }
  auto bytes = encode_fields(definition_, serialization_, *message);
  if (!bytes.ok()) return bytes.status().with_context(name());
  return bytes;
}

idf::Data MessageType::empty_header() const {
  for (const Field& field : definition_.root().fields)
    if (field.name == "header" && field.kind == FieldKind::kMessage)
      return empty_value(definition_, field);
  return {};
}

std::optional<SegmentNames> MessageType::segment(const idf::Data* value) const {
  if (is_image()) {
    const bool is_depth = value != nullptr && value->at("depth") != nullptr;
    return SegmentNames{"Vision", is_depth ? "Depth" : "RGB"};
  }
  const auto fits = [&](const TypeSegment& one) {
    return one.type == name() || (one.type.ends_with('/') && name().starts_with(one.type));
  };
  const auto* found = std::ranges::find_if(kSegments, fits);
  if (found == kSegments.end()) return std::nullopt;
  return SegmentNames{std::string(found->memory), std::string(found->segment)};
}

std::optional<Time> header_stamp(const idf::Data& value) {
  for (const char* path : {"header/stamp", "transforms/0/header/stamp"})
    if (const auto stamp = stamp_at(value, path)) return stamp;
  return std::nullopt;
}

}  // namespace engram::datasets::ros
