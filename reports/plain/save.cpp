// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/save.h"

#include <algorithm>
#include <cmath>

#include "ltm/codec/png.h"
#include "ltm/core/file.h"
#include "ltm/core/utf8.h"
#include "ltm/idf/json.h"
#include "ltm/idf/layout.h"
#include "ltm/memory/augmentation_json.h"
#include "ltm/store/checksum.h"
#include "ltm/store/segment_format.h"
#include "training/quality/psnr.h"
#include "training/quality/quality_metrics.h"

namespace engram::reports {

namespace {

/// Replaces the images of a value by the names of their files.
Json with_files(Json json, const std::vector<std::string>& paths,
                const std::vector<std::string>& files) {
  for (size_t i = 0; i < paths.size(); ++i) {
    Json* place = &json;
    for (const std::string& name : idf::split_path(paths[i]))
      place = &(*place)[name.starts_with('$') ? "$" + name : name];
    *place = Json{{"$file", files[i]}};
  }
  return json;
}

std::vector<std::string> image_paths(const idf::Data& data) {
  std::vector<std::string> paths;
  const idf::Layout layout = idf::Layout::of(data);
  for (const idf::TensorMember& member : layout.members())
    if (member.kind == idf::MemberKind::kImage) paths.push_back(member.path);
  return paths;
}

/// A time as a file name, such as "2022-02-18T13-06-56.492182": some file systems refuse colons.
std::string file_name(Time time) {
  std::string name = to_string(time);
  std::ranges::replace(name, ' ', 'T');
  std::ranges::replace(name, ':', '-');
  return name;
}

/// Most file systems take names of 255 bytes. A longer one keeps its beginning, and a checksum
/// tells it from others; the JSON has it whole.
std::string short_name(std::string name) {
  constexpr size_t kMaxBytes = 120;
  constexpr size_t kKeptBytes = 100;
  if (name.size() <= kMaxBytes) return name;
  size_t end = cut_utf8(name, kKeptBytes).size();
  // Nor may an escape like "%2F" be cut.
  if (const size_t escape = name.rfind('%', end); escape != std::string::npos && escape + 3 > end)
    end = std::min(end, escape);
  return fmt::format("{}~{:016x}", std::string_view(name).substr(0, end),
                     ltm::checksum(as_bytes(name)));
}

std::filesystem::path folder_of(const ltm::MemoryId& entity,
                                const std::filesystem::path& directory) {
  std::filesystem::path folder = directory;
  for (const std::string& name : entity.names()) folder /= short_name(ltm::segment_name(name));
  return folder;
}

Status write_image(const std::filesystem::path& path, const idf::Data& image) {
  ENGRAM_ASSIGN_OR_RETURN(const auto png, ltm::png_codec().encode(image.get<idf::NdArray>()));
  return replace_file(path, png);
}

}  // namespace

Json error_json(const ltm::MeasuredError& error) {
  Json json = Json::object();
  if (!std::isnan(error.image_mse)) json["psnr_db"] = training::psnr_db(error.image_mse);
  if (!std::isnan(error.number_mse)) json["rmse"] = std::sqrt(error.number_mse);
  return json;
}

Json bound_json(const ltm::MeasuredError& bound, double probability) {
  Json json{{"probability", probability}};
  json.update(error_json(bound));
  return json;
}

/// The members of a prediction. A missing error means that none is promised.
Json members_json(const std::vector<ltm::MemberPrediction>& members) {
  Json list = Json::array();
  for (const ltm::MemberPrediction& member : members) {
    const auto error_of = [&](double mse) {
      return member.is_image ? ltm::MeasuredError{mse} : ltm::MeasuredError{std::nan(""), mse};
    };
    Json one{{"path", member.path}, {"engine", member.engine}};
    if (!std::isnan(member.expected_mse))
      one["expected_error"] = error_json(error_of(member.expected_mse));
    if (!std::isnan(member.bound_mse)) one["error_bound"] = bound_json(error_of(member.bound_mse));
    one["copied"] = member.copied;
    one["is_moving"] = member.is_moving;
    list.push_back(std::move(one));
  }
  return list;
}

Result<Json> snapshot_json(const ltm::MemoryId& entity, const ltm::SnapshotResult& recalled,
                           const std::vector<std::vector<std::string>>* image_files) {
  Json json{{"id", entity.at(recalled.time).to_string()},
            {"time_ns", to_ns(recalled.time)},
            {"source", ltm::to_string(recalled.source)}};
  if (!recalled.model.empty()) json["model"] = recalled.model;
  if (!recalled.predictor.empty()) {
    json["predictor"] = recalled.predictor;
    json["horizon_s"] = to_seconds(recalled.horizon);
    if (!recalled.plan.empty()) json["plan"] = recalled.plan;
  }
  json["instances"] = Json::array();
  for (size_t i = 0; i < recalled.instances.size(); ++i) {
    const ltm::InstanceResult& instance = recalled.instances[i];
    ENGRAM_ASSIGN_OR_RETURN(Json data, idf::to_json(instance.data));
    if (image_files != nullptr)
      data = with_files(std::move(data), image_paths(instance.data), (*image_files)[i]);
    Json entry{{"created_ns", to_ns(instance.metadata.created)},
               {"provider", instance.metadata.provider},
               {"confidence", instance.metadata.confidence}};
    entry.update(ltm::augmentation_json(instance.metadata));
    if (instance.error) {
      const char* name = recalled.source == ltm::Source::kPredicted ? "expected_error" : "error";
      entry[name] = error_json(*instance.error);
    }
    // What faded from latents keeps its bound always.
    const bool is_certain = recalled.source == ltm::Source::kReconstructed;
    if (instance.bound)
      entry["error_bound"] = bound_json(*instance.bound, is_certain ? 1 : ltm::kBoundProbability);
    if (!instance.members.empty()) entry["members"] = members_json(instance.members);
    entry["data"] = std::move(data);
    json["instances"].push_back(std::move(entry));
  }
  return json;
}

Result<std::vector<std::filesystem::path>> save_snapshot(const ltm::MemoryId& entity,
                                                         const ltm::SnapshotResult& recalled,
                                                         const std::filesystem::path& directory) {
  const std::filesystem::path folder = folder_of(entity, directory);
  ENGRAM_RETURN_IF_ERROR(make_directories(folder));
  const std::string base = file_name(recalled.time);
  std::vector<std::filesystem::path> written;
  std::vector<std::vector<std::string>> image_files;
  for (size_t i = 0; i < recalled.instances.size(); ++i) {
    const idf::Data& data = recalled.instances[i].data;
    auto& files = image_files.emplace_back();
    for (const std::string& path : image_paths(data)) {
      std::string member;
      for (const std::string& name : idf::split_path(path))
        member += (member.empty() ? "" : ".") + ltm::segment_name(name);
      member = short_name(std::move(member));
      files.push_back(recalled.instances.size() == 1
                          ? fmt::format("{}.{}.png", base, member)
                          : fmt::format("{}.{}.{}.png", base, i, member));
      ENGRAM_RETURN_IF_ERROR(write_image(folder / files.back(), *data.at(path)));
      written.push_back(folder / files.back());
    }
  }
  ENGRAM_ASSIGN_OR_RETURN(const Json json, snapshot_json(entity, recalled, &image_files));
  // The JSON comes last: where it exists, so do the images that it names.
  written.push_back(folder / (base + ".json"));
  ENGRAM_RETURN_IF_ERROR(replace_file(written.back(), as_bytes(json.dump(2) + "\n")));
  return written;
}

}  // namespace engram::reports
