// SPDX-License-Identifier: Apache-2.0
#include "training/fade/fade.h"

#include "training/fade/fade_entity.h"

namespace engram::training {

Result<ltm::FadeReport> fade(const std::filesystem::path& store, const ltm::FadeSet& what,
                             const ProgressSink& progress, const std::stop_token& stop) {
  ltm::FadeReport report;
  for (const auto& [entity, parts] : what) {
    EntityFading fading(store, entity, progress, stop);
    Status status;
    for (const ltm::FadingSnapshots& part : parts)
      if (status.ok()) status = fading.run(part);
    report.entities[entity] = fading.report();
    report.is_cancelled = status.code() == StatusCode::kCancelled;
    if (report.is_cancelled) break;
    if (!status.ok()) return status.with_context("fading of '" + entity.to_string() + "'");
  }
  return report;
}

}  // namespace engram::training
