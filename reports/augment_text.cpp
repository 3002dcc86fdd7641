// SPDX-License-Identifier: Apache-2.0
#include "reports/augment_text.h"

#include "reports/plain/text.h"

namespace engram::reports {

namespace {

/// Returns the reason why snapshots were left out, or an empty text.
std::string left_out_text(const training::AugmentedEntity& entity) {
  if (entity.without_mask > 0) return ", where nothing tells the object";
  return entity.without_scene > 0 ? ", where not all that was there is known" : "";
}

}  // namespace

Json augment_json(const training::AugmentReport& report, const std::string& store,
                  const std::string& out, const training::AugmentOptions& options) {
  Json entities = Json::array();
  for (const training::AugmentedEntity& entity : report.entities) {
    Json json{{"id", entity.entity.to_string()},     {"snapshots", entity.snapshots},
              {"instances", entity.instances},       {"left_out", entity.left_out},
              {"without_mask", entity.without_mask}, {"without_scene", entity.without_scene},
              {"stored_bytes", entity.stored_bytes}};
    if (!entity.skipped_reason.empty()) json["skipped_reason"] = entity.skipped_reason;
    entities.push_back(std::move(json));
  }
  return {{"store", store},
          {"out", out},
          {"source", ltm::to_string(ltm::Source::kAugmented)},
          {"seed", options.seed},
          {"copies", options.copies},
          {"damaged_journal_places", report.damaged_places},
          {"is_cancelled", report.is_cancelled},
          {"entities", std::move(entities)}};
}

void print_augmented(const training::AugmentReport& report, const std::string& out) {
  print(fmt::format("Augmented store {}", out));
  for (const training::AugmentedEntity& entity : report.entities) {
    print("\n" + entity.entity.printable());
    if (!entity.skipped_reason.empty()) {
      print("  skipped    " + entity.skipped_reason);
      continue;
    }
    print(fmt::format("  made       {} of {} snapshots", count_text(entity.instances),
                      count_text(entity.snapshots)));
    if (entity.left_out > 0)
      print(fmt::format("  left out   {}{}", count_text(entity.left_out), left_out_text(entity)));
    print("  stored     " + bytes_text(static_cast<double>(entity.stored_bytes)));
  }
}

}  // namespace engram::reports
