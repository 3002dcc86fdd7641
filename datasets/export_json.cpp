// SPDX-License-Identifier: Apache-2.0
#include "datasets/export_json.h"

#include <algorithm>
#include <cmath>

#include "datasets/export_names.h"
#include "ltm/core/utf8.h"
#include "ltm/idf/json.h"
#include "ltm/memory/augmentation_json.h"

namespace engram::datasets {

namespace {

Json error_json(const ltm::MeasuredError& error) {
  Json json = Json::object();
  if (!std::isnan(error.image_mse)) json["image_mse"] = error.image_mse;
  if (!std::isnan(error.number_mse)) json["number_mse"] = error.number_mse;
  return json;
}

/// Recursion is safe, because values from a store are nested at most idf::kMaxDepth deep.
bool is_all_utf8(const idf::Data& data) {
  if (const auto* text = data.get_if<std::string>()) return is_utf8(*text);
  if (const auto* list = data.get_if<idf::List>()) return std::ranges::all_of(*list, is_all_utf8);
  const auto* dict = data.get_if<idf::Dict>();
  return dict == nullptr || std::ranges::all_of(*dict, [](const idf::DictEntry& entry) {
           return is_utf8(entry.key) && is_all_utf8(entry.value);
         });
}

Json data_json(const ltm::InstanceResult& instance, const std::vector<ImageFile>& files,
               ExportReport& report) {
  idf::Data data = instance.data;
  for (const ImageFile& image : files) *data.at(image.path) = idf::None{};
  auto json = idf::to_json(data);
  if (!json.ok() || !is_all_utf8(data)) {
    ++report.not_carried["values with texts that are no UTF-8"];
    return nullptr;
  }
  for (const ImageFile& image : files) {
    Json* place = &*json;
    const bool is_whole = image.path.empty();
    for (const std::string& key :
         is_whole ? std::vector<std::string>() : idf::split_path(image.path))
      place = &(*place)[key.starts_with('$') ? "$" + key : key];
    *place = Json{{"$file", image.file}};
  }
  return std::move(json).value();
}

std::string provider_of(const ltm::InstanceMetadata& metadata, ExportReport& report) {
  if (is_utf8(metadata.provider)) return metadata.provider;
  ++report.not_carried["names of providers that are no UTF-8"];
  return "";
}

}  // namespace

Json snapshot_head(const ltm::MemoryId& entity, const ltm::SnapshotResult& snapshot) {
  Json json{{"id", entity.at(snapshot.time).to_string()},
            {"time_ns", to_ns(snapshot.time)},
            {"time", iso_time(snapshot.time)},
            {"source", ltm::to_string(snapshot.source)}};
  if (!snapshot.model.empty()) json["model"] = snapshot.model;
  if (snapshot.predictor.empty()) return json;
  json["predictor"] = snapshot.predictor;
  json["horizon_ns"] = snapshot.horizon.count();
  return json;
}

Json instance_json(const ltm::InstanceResult& instance, const std::vector<ImageFile>& files,
                   ExportReport& report) {
  const ltm::InstanceMetadata& metadata = instance.metadata;
  Json json{{"index", instance.index},
            {"created_ns", to_ns(metadata.created)},
            {"sent_ns", to_ns(metadata.sent)},
            {"arrived_ns", to_ns(metadata.arrived)},
            {"provider", provider_of(metadata, report)},
            {"confidence", metadata.confidence}};
  json.update(ltm::augmentation_json(metadata));
  if (instance.error) json["error"] = error_json(*instance.error);
  json["data"] = data_json(instance, files, report);
  return json;
}

}  // namespace engram::datasets
