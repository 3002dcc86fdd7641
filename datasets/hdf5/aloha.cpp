// SPDX-License-Identifier: Apache-2.0
// ALOHA: a file per episode.
#include <algorithm>

#include "datasets/hdf5/attributes.h"
#include "datasets/hdf5/dialect.h"

namespace engram::datasets {

namespace {

constexpr double kHz = 50;
constexpr std::string_view kImages = "observations/images/";
constexpr std::string_view kObservations = "observations/";

bool is_compressed(const h5::ArrayInfo& info) {
  return (info.element == h5::Element{} && info.shape.size() == 2) ||
         (info.element.kind == h5::Kind::kBytes && info.shape.size() == 1);
}

class Aloha final : public Dialect {
 public:
  [[nodiscard]] std::string_view name() const override { return "aloha"; }
  [[nodiscard]] std::string_view about() const override {
    return "episodes of ALOHA, an HDF5 file each";
  }

  [[nodiscard]] bool recognises(const h5::File& file) const override {
    const auto names = file.list("/").value_or({});
    const auto is_action = [](const std::string& found) { return found.starts_with("action"); };
    return std::ranges::any_of(names, is_action) && file.exists("/observations").value_or(false);
  }

  [[nodiscard]] bool has_file_per_episode() const override { return true; }

  [[nodiscard]] bool can_compress() const override { return true; }

  [[nodiscard]] Result<std::vector<EpisodeGroup>> episodes(const h5::File& file,
                                                           const std::string& stem) const override {
    if (!recognises(file))
      return invalid_argument(
          "'{}': needs an array '/action', or whose name begins so, and a group '/observations'",
          file.path().string());
    return std::vector<EpisodeGroup>{{stem, ""}};
  }

  [[nodiscard]] Rate rate(const h5::File& /*file*/) const override { return {kHz}; }

  [[nodiscard]] RowPlace place(const std::string& name, const h5::ArrayInfo& info) const override {
    if (name.starts_with(kImages)) {
      const std::string camera = dotted(name.substr(kImages.size()));
      if (is_compressed(info)) return {"Vision", "RGB", camera, RowRole::kCompressed};
      const RowRole role = picture_role(name, info);
      if (role == RowRole::kImage) return {"Vision", "RGB", camera, role};
      if (role == RowRole::kDepth) return {"Vision", "Depth", camera, role};
    }
    if (!name.starts_with(kObservations))
      return name.find("action") != std::string::npos ? RowPlace{"Skills", "Commands", dotted(name)}
                                                      : RowPlace{"Data", "aloha", dotted(name)};
    const std::string below = dotted(name.substr(kObservations.size()));
    if (is_proprioception(below)) return {"RobotState", "Proprioception", below};
    if (picture_role(name, info) == RowRole::kDepth)
      return {"Vision", "Depth", below, RowRole::kDepth};
    return {"Data", "aloha", below};
  }

  /// This array has the lengths of compressed images, which also end where their zeros begin.
  [[nodiscard]] bool is_description(const std::string& name) const override {
    return name == "compress_len";
  }

  [[nodiscard]] idf::Dict describe_file(const h5::File& /*file*/,
                                        ReadingReport& /*report*/) const override {
    return {};
  }

  [[nodiscard]] std::string group_of(const std::string& /*episode*/) const override { return ""; }

  [[nodiscard]] std::string array_name(const ltm::MemoryId& entity,
                                       const std::string& member) const override {
    const std::string below = member.empty() ? "" : "/" + member;
    const std::string name = array_stem(entity) + below;
    if (entity.names()[0] == "Vision") return std::string(kImages) + name;
    if (entity.names()[0] == "Skills" && entity.names()[1] == "Commands")
      return entity.names()[3].starts_with("action") ? name : "action_" + name;
    return std::string(kObservations) + name;
  }

  void complete(idf::Dict& attributes, uint64_t /*rows*/) const override {
    // Programs of ALOHA read this attribute of every episode.
    if (attributes.find("sim") == nullptr) attributes.set("sim", false);
  }

  [[nodiscard]] Status write_description(h5::File& file, const idf::Dict& /*description*/,
                                         uint64_t /*rows*/) const override {
    return file.make_group("/observations/images");
  }
};

}  // namespace

const Dialect& aloha_dialect() {
  static const Aloha dialect;
  return dialect;
}

}  // namespace engram::datasets
