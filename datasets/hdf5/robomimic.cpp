// SPDX-License-Identifier: Apache-2.0
// robomimic and LIBERO: one file with a group per demonstration.
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <tuple>

#include "datasets/hdf5/attributes.h"
#include "datasets/hdf5/dialect.h"
#include "ltm/core/utf8.h"

namespace engram::datasets {

namespace {

constexpr double kAssumedHz = 20;
constexpr uint64_t kMaxMaskNames = 1 << 20;

/// Orders "demo_2" before "demo_10".
std::tuple<size_t, std::string> by_number(const std::string& name) {
  const size_t digits = name.find_last_not_of("0123456789") + 1;
  return {name.size() - std::min(digits, name.size()), name};
}

bool is_group(const h5::File& file, const std::string& path) {
  return file.exists(path).value_or(false) && file.is_group(path).value_or(false);
}

std::string_view last_part(std::string_view name) {
  return name.substr(name.rfind('/') + 1);
}

class Robomimic final : public Dialect {
 public:
  [[nodiscard]] std::string_view name() const override { return "robomimic"; }
  [[nodiscard]] std::string_view about() const override {
    return "demonstrations in one HDF5 file, of robomimic and LIBERO";
  }

  [[nodiscard]] bool recognises(const h5::File& file) const override {
    if (!is_group(file, "/data")) return false;
    const auto names = file.list("/data");
    return names.ok() && !names->empty() && is_group(file, "/data/" + names->front());
  }

  [[nodiscard]] bool has_file_per_episode() const override { return false; }

  [[nodiscard]] bool can_compress() const override { return false; }

  [[nodiscard]] Result<std::vector<EpisodeGroup>> episodes(
      const h5::File& file, const std::string& /*stem*/) const override {
    if (!is_group(file, "/data"))
      return invalid_argument(
          "'{}': has no group '/data', needs one with a group per demonstration",
          file.path().string());
    ENGRAM_ASSIGN_OR_RETURN(auto names, file.list("/data"));
    std::ranges::sort(names, {}, by_number);
    std::vector<EpisodeGroup> episodes;
    for (const std::string& name : names)
      if (is_group(file, "/data/" + name)) episodes.push_back({name, "/data/" + name});
    if (episodes.empty())
      return invalid_argument("'{}': '/data' has no group, needs one per demonstration",
                              file.path().string());
    return episodes;
  }

  [[nodiscard]] Rate rate(const h5::File& file) const override {
    const auto text = file.attribute("/data", "env_args");
    if (text.ok() && text->texts.size() == 1) {
      const auto json = nlohmann::json::parse(text->texts[0], nullptr, false);
      const auto kwargs = json.is_object() ? json.find("env_kwargs") : json.end();
      if (json.is_object() && kwargs != json.end() && kwargs->is_object()) {
        // Only the arguments of the simulator tell the rate; the rows have no times.
        const auto found = kwargs->find("control_freq");
        if (found != kwargs->end() && found->is_number()) return {found->get<double>()};
      }
    }
    return {kAssumedHz, true};
  }

  [[nodiscard]] RowPlace place(const std::string& name, const h5::ArrayInfo& info) const override {
    const std::string short_name = dotted(name.starts_with("obs/") ? name.substr(4) : name);
    switch (picture_role(last_part(name), info)) {
      case RowRole::kImage:
        return {"Vision", "RGB", short_name, RowRole::kImage};
      case RowRole::kDepth:
        return {"Vision", "Depth", short_name, RowRole::kDepth};
      default:
        break;
    }
    if (name.starts_with("action")) return {"Skills", "Commands", short_name};
    if (name == "rewards" || name == "dones") return {"Tasks", "Feedback", short_name};
    if (is_proprioception(last_part(name))) return {"RobotState", "Proprioception", short_name};
    return {"Data", "robomimic", short_name};
  }

  [[nodiscard]] bool is_description(const std::string& /*name*/) const override { return false; }

  [[nodiscard]] idf::Dict describe_file(const h5::File& file,
                                        ReadingReport& report) const override {
    idf::Dict description{{"file", read_attributes(file, "/", report)},
                          {"data", read_attributes(file, "/data", report)}};
    for (const std::string& name : file.list("/").value_or({}))
      if (name != "data" && name != "mask") ++report.not_carried["groups beside data and mask"];
    if (is_group(file, "/mask")) description.set("mask", read_masks(file, report));
    return description;
  }

  [[nodiscard]] std::string group_of(const std::string& episode) const override {
    return "/data/" + episode;
  }

  [[nodiscard]] std::string array_name(const ltm::MemoryId& entity,
                                       const std::string& member) const override {
    const std::string below = member.empty() ? "" : "/" + member;
    const std::string name = array_stem(entity) + below;
    if (entity.names()[0] == "Skills" && entity.names()[1] == "Commands")
      return entity.names()[3].starts_with("action") ? name : "actions_" + name;
    return entity.names()[0] == "Tasks" ? name : "obs/" + name;
  }

  void complete(idf::Dict& attributes, uint64_t rows) const override {
    set_number(attributes, "num_samples", rows);
  }

  [[nodiscard]] Status write_description(h5::File& file, const idf::Dict& description,
                                         uint64_t rows) const override {
    const auto part = [&](const char* name) {
      const idf::Data* found = description.find(name);
      return found != nullptr && found->is<idf::Dict>() ? found->get<idf::Dict>() : idf::Dict();
    };
    ENGRAM_RETURN_IF_ERROR(file.make_group("/data"));
    ENGRAM_RETURN_IF_ERROR(write_attributes(file, "/", part("file")));
    idf::Dict data = part("data");
    set_number(data, "total", rows);
    // robomimic reads the environment from this attribute, so it must exist.
    if (data.find("env_args") == nullptr) data.set("env_args", "{}");
    ENGRAM_RETURN_IF_ERROR(write_attributes(file, "/data", data));
    return write_masks(file, part("mask"));
  }

 private:
  static idf::Dict read_masks(const h5::File& file, ReadingReport& report) {
    idf::Dict masks;
    for (const std::string& name : file.list("/mask").value_or({})) {
      const std::string path = "/mask/" + name;
      const auto info = file.array_info(path);
      const auto names = info.ok() && info->rows() <= kMaxMaskNames
                             ? file.read_array_texts(path, 0, info->rows())
                             : Result<std::vector<std::string>>(
                                   info.status().ok() ? data_loss("too many") : info.status());
      if (names.ok() && std::ranges::all_of(*names, is_utf8))
        masks.set(name, idf::List(names->begin(), names->end()));
      else
        ++report.not_carried["masks that are no lists of names"];
    }
    return masks;
  }

  static Status write_masks(h5::File& file, const idf::Dict& masks) {
    for (const auto& [name, value] : masks) {
      std::vector<std::string> names;
      size_t longest = 1;
      for (const idf::Data& one : value.is<idf::List>() ? value.get<idf::List>() : idf::List()) {
        if (!one.is<std::string>()) continue;
        names.push_back(one.get<std::string>());
        longest = std::max(longest, names.back().size());
      }
      const std::string path = "/mask/" + name;
      ENGRAM_RETURN_IF_ERROR(file.create_array(
          path, {{h5::Kind::kFixedText, h5::Type::kUInt8, longest}, {names.size()}}));
      ENGRAM_RETURN_IF_ERROR(file.write_array_texts(path, 0, names));
      ENGRAM_RETURN_IF_ERROR(file.finish_array(path));
    }
    return {};
  }
};

}  // namespace

const Dialect& robomimic_dialect() {
  static const Robomimic dialect;
  return dialect;
}

bool is_proprioception(std::string_view name) {
  constexpr std::array kParts{"robot", "joint", "gripper", "eef", "ee_", "qpos", "qvel", "effort"};
  return std::ranges::any_of(
      kParts, [&](const char* part) { return name.find(part) != std::string_view::npos; });
}

RowRole picture_role(std::string_view name, const h5::ArrayInfo& info) {
  const auto& shape = info.shape;
  const bool is_plain = info.element.kind == h5::Kind::kNumber;
  if (is_plain && info.element.type == h5::Type::kUInt8 && shape.size() == 4 &&
      (shape[3] == 1 || shape[3] == 3) && shape[1] > 0 && shape[2] > 0)
    return RowRole::kImage;
  const bool is_depth = name.find("depth") != std::string_view::npos &&
                        (shape.size() == 3 || (shape.size() == 4 && shape[3] == 1));
  const bool is_distance =
      info.element.type == h5::Type::kUInt16 || info.element.type == h5::Type::kFloat32;
  return is_plain && is_depth && is_distance ? RowRole::kDepth : RowRole::kValues;
}

void set_number(idf::Dict& attributes, std::string_view name, uint64_t value) {
  const idf::Data* found = attributes.find(name);
  if (found == nullptr || found->as_number() != static_cast<double>(value))
    attributes.set(name, static_cast<int64_t>(value));
}

std::string array_stem(const ltm::MemoryId& entity) {
  std::string name = dotted(entity.names()[3]);
  const bool is_depth = entity.names()[0] == "Vision" && entity.names()[1] == "Depth";
  if (is_depth && name.find("depth") == std::string::npos) name += "_depth";
  return name;
}

std::string dotted(std::string_view text) {
  std::string name(text);
  std::ranges::replace(name, '/', '.');
  return name;
}

}  // namespace engram::datasets
