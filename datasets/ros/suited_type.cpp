// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/suited_type.h"

#include <algorithm>

namespace engram::datasets::ros {

namespace {

/// Returns true for a picture that an Image message can hold unchanged.
bool is_bare_picture(const idf::Data& value) {
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr || dict->size() != 1) return false;
  const auto& [key, member] = *dict->begin();
  const auto* array = member.get_if<idf::NdArray>();
  if (array == nullptr || array->rank() != 3 || array->count() == 0) return false;
  const auto type = array->type();
  const int64_t channels = array->shape()[2];
  if (key == "depth")
    return channels == 1 &&
           (type == idf::ElementType::kUInt16 || type == idf::ElementType::kFloat32);
  return key == "image" &&
         ((type == idf::ElementType::kUInt8 && (channels == 1 || channels == 3)) ||
          (type == idf::ElementType::kUInt16 && channels == 1));
}

bool is_bare_joints(const idf::Data& value) {
  const auto* dict = value.get_if<idf::Dict>();
  const idf::Data* names = value.at("name");
  if (dict == nullptr || dict->size() != 4 || dict->begin()->key != "name" ||
      !names->is<idf::List>())
    return false;
  const bool are_texts = std::ranges::all_of(
      names->get<idf::List>(), [](const idf::Data& name) { return name.is<std::string>(); });
  const auto entry = [&](size_t i) -> const auto& {
    return *(dict->begin() + static_cast<ptrdiff_t>(i));
  };
  const auto is_numbers = [&](size_t i, std::string_view key) {
    const auto* array = entry(i).value.get_if<idf::NdArray>();
    return entry(i).key == key && array != nullptr && array->rank() == 1 &&
           array->type() == idf::ElementType::kFloat64;
  };
  return are_texts && is_numbers(1, "position") && is_numbers(2, "velocity") &&
         is_numbers(3, "effort");
}

/// Returns a header with nothing but a time, if it can hold that; none if the type has no header.
idf::Data header_at(const MessageType& type, Time time) {
  constexpr int64_t kNsPerSecond = 1'000'000'000;
  idf::Data header = type.empty_header();
  if (header.at("stamp") == nullptr) return header;
  const bool is_ros1 = header.at("stamp/nsec") != nullptr;
  const int64_t end = is_ros1 ? int64_t{1} << 32 : int64_t{1} << 31;
  const int64_t seconds = to_ns(time) / kNsPerSecond;
  if (to_ns(time) >= 0 && seconds < end)
    header.get_if<idf::Dict>()->set(
        "stamp",
        idf::Dict{{"sec", seconds}, {is_ros1 ? "nsec" : "nanosec", to_ns(time) % kNsPerSecond}});
  return header;
}

}  // namespace

std::string_view suited_type(const idf::Data& value, bool is_compressed) {
  if (is_bare_picture(value))
    return is_compressed && value.at("image") != nullptr ? "sensor_msgs/CompressedImage"
                                                         : "sensor_msgs/Image";
  return is_bare_joints(value) ? "sensor_msgs/JointState" : "";
}

Result<std::vector<std::byte>> encode_bare(const MessageType& type, const idf::Data& value,
                                           int jpeg_quality, std::optional<Time> stamp) {
  if (value.at("header") != nullptr || value.at("encoding") != nullptr)
    return invalid_argument(
        "has 'header' or 'encoding', needs a value without: they go on reading");
  if (!stamp || !value.is<idf::Dict>()) return type.encode(value, jpeg_quality);
  idf::Data header = header_at(type, *stamp);
  if (header.is<idf::None>()) return type.encode(value, jpeg_quality);
  idf::Dict stamped = value.get<idf::Dict>();
  stamped.set("header", std::move(header));
  return type.encode(stamped, jpeg_quality);
}

idf::Data without_header(const idf::Data& value) {
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return value;
  idf::Dict bare;
  for (const auto& [key, member] : *dict)
    if (key != "header" && key != "encoding") bare.append_unique(key, member);
  return bare;
}

}  // namespace engram::datasets::ros
