// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/read_context.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace engram::ltm {

namespace {

/// Values that are nested deeper have no place; a hostile value must not exhaust the stack.
constexpr size_t kMaxPlaceDepth = 16;
constexpr size_t kMaxPlacesOfSnapshot = 4096;

struct FoundPose {
  std::string_view member;
  std::string_view frame;
  std::array<double, 3> position{};
  std::array<double, 4> orientation{};
};

std::optional<double> number_at(const idf::Dict& dict, std::string_view key) {
  const idf::Data* found = dict.find(key);
  return found == nullptr ? std::nullopt : found->as_number();
}

/// Reads an array or a dict of numbers. NaN and infinity are no place.
template <size_t N>
bool read_numbers(const idf::Data& value, const std::array<const char*, N>& keys,
                  std::array<double, N>& numbers) {
  if (const auto* array = value.get_if<idf::NdArray>()) {
    if (array->count() != static_cast<int64_t>(N)) return false;
    if (array->type() == idf::ElementType::kFloat32) {
      for (size_t i = 0; i < N; ++i) numbers[i] = array->values<float>()[i];
    } else if (array->type() == idf::ElementType::kFloat64) {
      for (size_t i = 0; i < N; ++i) numbers[i] = array->values<double>()[i];
    } else {
      return false;
    }
  } else if (const auto* dict = value.get_if<idf::Dict>()) {
    for (size_t i = 0; i < N; ++i) {
      const auto number = number_at(*dict, keys[i]);
      if (!number) return false;
      numbers[i] = *number;
    }
  } else {
    return false;
  }
  for (const double number : numbers)
    if (!std::isfinite(number)) return false;
  return true;
}

bool read_pose(const idf::Dict& dict, FoundPose& pose) {
  const idf::Data* position = dict.find("position");
  const idf::Data* orientation = dict.find("orientation");
  return position != nullptr && orientation != nullptr &&
         read_numbers<3>(*position, {"x", "y", "z"}, pose.position) &&
         read_numbers<4>(*orientation, {"w", "x", "y", "z"}, pose.orientation);
}

/// The frame that a dict tells of what lies in it; ROS puts it into a header.
std::string_view told_frame(const idf::Dict& dict, std::string_view outer) {
  const auto text = [](const idf::Dict& in, std::string_view key) -> std::string_view {
    const idf::Data* found = in.find(key);
    const auto* told = found == nullptr ? nullptr : found->get_if<std::string>();
    if (told == nullptr) return {};
    return told->starts_with('/') ? std::string_view(*told).substr(1) : std::string_view(*told);
  };
  for (const char* key : {"frame_id", "frame"})
    if (const auto frame = text(dict, key); !frame.empty()) return frame;
  const idf::Data* header = dict.find("header");
  const auto* inner = header == nullptr ? nullptr : header->get_if<idf::Dict>();
  if (inner != nullptr)
    if (const auto frame = text(*inner, "frame_id"); !frame.empty()) return frame;
  return outer;
}

/// Collects the poses in a value. `named` is the frame that a member's name told.
void find_poses(const idf::Data& value, std::string_view member, std::string_view named,
                std::string_view told, size_t depth, std::vector<FoundPose>& poses) {
  if (depth > kMaxPlaceDepth || poses.size() >= kMaxPlacesOfSnapshot) return;
  if (const auto* list = value.get_if<idf::List>()) {
    for (const idf::Data& element : *list)
      find_poses(element, member, named, told, depth + 1, poses);
    return;
  }
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return;
  told = told_frame(*dict, told);
  FoundPose pose;
  if (read_pose(*dict, pose)) {
    pose.member = member;
    pose.frame = named.empty() ? told : named;
    poses.push_back(pose);
    return;
  }
  for (const idf::DictEntry& entry : *dict) {
    if (!entry.value.is<idf::Dict>() && !entry.value.is<idf::List>()) continue;
    const std::string_view frame = frame_in_name(entry.key);
    find_poses(entry.value, entry.key, frame.empty() ? named : frame, told, depth + 1, poses);
  }
}

bool is_calibration(std::string_view path) {
  for (const char* word : {"calibration", "intrinsics", "camera_info"})
    if (path.find(word) != std::string_view::npos) return true;
  return false;
}

std::optional<int64_t> time_at(const idf::Dict& dict, std::string_view key) {
  const idf::Data* found = dict.find(key);
  const auto* ns = found == nullptr ? nullptr : found->get_if<int64_t>();
  return ns == nullptr ? std::nullopt : std::optional(*ns);
}

EntityContext::Visibility visibility_of(const idf::Dict& dict) {
  for (const char* key : {"is_visible", "visible"}) {
    const idf::Data* found = dict.find(key);
    const auto* told = found == nullptr ? nullptr : found->get_if<bool>();
    if (told != nullptr)
      return *told ? EntityContext::Visibility::kVisible : EntityContext::Visibility::kHidden;
  }
  return EntityContext::Visibility::kUntold;
}

/// The pose of the camera, if several are there.
const FoundPose* pose_of_camera(const std::vector<FoundPose>& poses) {
  for (const FoundPose& pose : poses)
    if (pose.member.ends_with("camera")) return &pose;
  return poses.empty() ? nullptr : &poses.front();
}

}  // namespace

bool tells_context(const idf::Type& type) {
  if (type.kind() == idf::TypeKind::kPose || type.kind() == idf::TypeKind::kMemoryLink ||
      type.kind() == idf::TypeKind::kDict)
    return true;
  static constexpr std::array<std::string_view, 4> kTelling = {"orientation", "started",
                                                               "is_visible", "visible"};
  return std::ranges::any_of(type.parts(), [](const idf::Member& part) {
    return std::ranges::find(kTelling, part.name) != kTelling.end() || tells_context(part.type);
  });
}

std::string_view frame_in_name(std::string_view member) {
  constexpr std::string_view kPose = "pose_";
  if (!member.starts_with(kPose)) return {};
  member.remove_prefix(kPose.size());
  const size_t end = member.find('_');
  return end == std::string_view::npos ? std::string_view() : member.substr(0, end);
}

std::optional<Intrinsics> intrinsics_in(const idf::Data& value) {
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return std::nullopt;
  Intrinsics read;
  const std::array<std::pair<const char*, double*>, 6> members = {{{"fx", &read.fx},
                                                                   {"fy", &read.fy},
                                                                   {"cx", &read.cx},
                                                                   {"cy", &read.cy},
                                                                   {"width", &read.width},
                                                                   {"height", &read.height}}};
  for (const auto& [key, to] : members) {
    const auto number = number_at(*dict, key);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    *to = *number;
  }
  return read;
}

EntityContext ContextReader::take() && {
  if (!context_.visibility.empty())
    context_.visibility.resize(context_.times.size(), EntityContext::Visibility::kUntold);
  context_.find_runs();
  return std::move(context_);
}

void ContextReader::add(Time time, std::span<const InstanceResult> instances) {
  context_.times.push_back(time);
  for (const InstanceResult& instance : instances) add_value(instance.data, instance.index);
}

std::vector<Link> ContextReader::links_of(const idf::Data& value) const {
  if (type_) return find_links(value, *type_);
  std::vector<Link> links = find_links(value);
  // Without a type a text that names an entity alone is no link, unless its member says so.
  if (const auto* dict = value.get_if<idf::Dict>())
    for (const idf::DictEntry& entry : *dict) {
      const auto* text = entry.value.get_if<std::string>();
      if (text == nullptr || !is_calibration(entry.key)) continue;
      auto id = MemoryId::parse(*text);
      if (id.ok() && id->is_entity()) links.push_back({entry.key, *std::move(id)});
    }
  return links;
}

void ContextReader::add_value(const idf::Data& value, int32_t instance) {
  const auto snapshot = static_cast<uint32_t>(context_.times.size() - 1);
  std::optional<int32_t> calibration;
  for (const Link& link : links_of(value)) {
    if (!link.id.has_entity()) continue;
    if (!calibration && is_calibration(link.path))
      calibration = static_cast<int32_t>(context_.links.size());
    context_.links.snapshot.push_back(snapshot);
    context_.links.instance.push_back(instance);
    context_.links.target.push_back(targets_.of(link.id.entity(), context_.targets));
    context_.links.time.push_back(link.id.time() ? to_ns(*link.id.time())
                                                 : EntityContext::Links::kNoTime);
    context_.links.index.push_back(link.id.index().value_or(EntityContext::Links::kNoInstance));
  }
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return;
  std::vector<FoundPose> poses;
  find_poses(value, {}, {}, {}, 0, poses);
  for (const FoundPose& pose : poses) {
    context_.places.snapshot.push_back(snapshot);
    context_.places.frame.push_back(frames_.of(std::string(pose.frame), context_.frames));
    context_.places.position.insert(context_.places.position.end(), pose.position.begin(),
                                    pose.position.end());
  }
  if (!calibration)
    if (const auto own = intrinsics_in(value))
      calibration = -1 - static_cast<int32_t>(index_of_lens(context_.intrinsics, *own));
  if (const FoundPose* pose = pose_of_camera(poses); calibration && pose != nullptr) {
    context_.cameras.snapshot.push_back(snapshot);
    context_.cameras.instance.push_back(instance);
    context_.cameras.frame.push_back(frames_.of(std::string(pose->frame), context_.frames));
    context_.cameras.position.insert(context_.cameras.position.end(), pose->position.begin(),
                                     pose->position.end());
    context_.cameras.orientation.insert(context_.cameras.orientation.end(),
                                        pose->orientation.begin(), pose->orientation.end());
    context_.cameras.calibration.push_back(*calibration);
  }
  if (const auto started = time_at(*dict, "started")) {
    context_.spans.snapshot.push_back(snapshot);
    context_.spans.started.push_back(*started);
    context_.spans.ended.push_back(time_at(*dict, "ended").value_or(EntityContext::Spans::kOpen));
  }
  const auto visibility = visibility_of(*dict);
  if (visibility == EntityContext::Visibility::kUntold) return;
  context_.visibility.resize(context_.times.size(), EntityContext::Visibility::kUntold);
  // Of several instances one that is visible is enough.
  context_.visibility.back() = std::max(context_.visibility.back(), visibility);
}

}  // namespace engram::ltm
