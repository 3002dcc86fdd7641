// SPDX-License-Identifier: Apache-2.0
#include "reports/costs_text.h"

#include <fmt/format.h>

#include "reports/plain/text.h"

namespace engram::reports {

using training::Stage;

namespace {

/// A stage with a smaller share is not worth a word.
constexpr double kSmallestShare = 0.005;

Json time_json(const training::StageTime& time) {
  return {{"processor_seconds", time.processor_seconds}, {"seconds", time.seconds}};
}

}  // namespace

std::vector<std::string> costs_text(const training::EntityCosts& costs) {
  std::vector<std::string> lines;
  const training::StageTime total = costs.stages.total();
  if (!(total.processor_seconds > 0)) return lines;
  std::vector<std::string> shares;
  for (size_t i = 0; i < training::kStages; ++i) {
    const double share =
        costs.stages.of(static_cast<Stage>(i)).processor_seconds / total.processor_seconds;
    if (share >= kSmallestShare)
      shares.push_back(
          fmt::format("{} {:.0f} %", training::to_string(static_cast<Stage>(i)), 100 * share));
  }
  lines.push_back(
      fmt::format("processor time {:.1f} s: {}", total.processor_seconds, fmt::join(shares, ", ")));
  if (costs.images_encoded == 0) return lines;
  lines.push_back(fmt::format("{} images encoded", count_text(costs.images_encoded)));
  if (!costs.encodes.empty())
    lines.back() += fmt::format("; {:.1f} encodes a chain as {}, {:g} in the median",
                                costs.mean_encodes(), costs.video, costs.median_encodes());
  if (costs.known_videos > 0)
    lines.back() += fmt::format("; {} videos were known", count_text(costs.known_videos));
  return lines;
}

Json stages_json(const training::StageTimes& stages) {
  Json json = Json::object();
  for (size_t i = 0; i < training::kStages; ++i)
    json[std::string(training::to_string(static_cast<Stage>(i)))] =
        time_json(stages.of(static_cast<Stage>(i)));
  return json;
}

Json encodes_json(const training::EntityCosts& costs) {
  if (costs.images_encoded == 0) return nullptr;
  Json json{{"images", costs.images_encoded},
            {"video", costs.video.empty() ? Json(nullptr) : Json(costs.video)},
            {"searches", costs.encodes.size()},
            {"known_videos", costs.known_videos},
            {"mean_per_search", nullptr},
            {"median_per_search", nullptr}};
  if (costs.encodes.empty()) return json;
  json["mean_per_search"] = costs.mean_encodes();
  json["median_per_search"] = costs.median_encodes();
  return json;
}

}  // namespace engram::reports
