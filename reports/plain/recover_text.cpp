// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/recover_text.h"

#include "reports/plain/findings.h"
#include "reports/plain/text.h"

namespace engram::reports {

namespace {

Json entities_json(const ltm::RecoverReport& report) {
  Json entities = Json::array();
  for (const auto& [id, counts] : report.entities)
    entities.push_back({{"id", id.to_string()},
                        {"recorded_saved", counts.recorded},
                        {"recorded_lost", counts.recorded_lost},
                        {"latent_saved", counts.latent},
                        {"latent_lost", counts.latent_lost},
                        {"unsealed_saved", counts.unsealed},
                        {"left_out_of_future", counts.too_late}});
  return entities;
}

}  // namespace

Json recover_json(const ltm::RecoverReport& report, const std::string& source,
                  const std::string& target) {
  return {{"source", source},
          {"target", target},
          {"lossless", !report.has_loss()},
          {"manifest_rebuilt", report.is_rebuilt},
          {"segments_copied", report.segments_copied},
          {"segments_rewritten", report.segments_rewritten},
          {"segments_lost", report.segments_lost},
          {"models_saved", report.models},
          {"models_lost", report.models_lost},
          {"journals", report.journals},
          {"damaged_journal_places", report.damaged_places},
          {"entities", entities_json(report)},
          {"findings", findings_json(report.findings)}};
}

void print_recovered(const ltm::RecoverReport& report, const std::string& target) {
  print_findings(report.findings);
  // Of many entities people want to read of those that lost something.
  constexpr size_t kMaxTold = 200;
  const bool is_each = report.entities.size() <= kMaxTold;
  TextTable table({"snapshots", "recorded", "lost", "latent", "lost", "unsealed"});
  size_t whole = 0;
  for (const auto& [id, counts] : report.entities) {
    const bool has_loss = counts.recorded_lost + counts.latent_lost > 0;
    whole += has_loss ? 0 : 1;
    if (is_each || has_loss)
      table.add({id.printable(), count_text(counts.recorded), count_text(counts.recorded_lost),
                 count_text(counts.latent), count_text(counts.latent_lost),
                 count_text(counts.unsealed)});
  }
  if (is_each || whole < report.entities.size()) print(table.to_string());
  if (!is_each) print(fmt::format("{} entities lost nothing", count_text(whole)));
  for (const auto& [id, counts] : report.entities)
    if (counts.too_late > 0)
      print(fmt::format("{}: {} snapshots from the future were left out", id.printable(),
                        count_text(counts.too_late)));
  print(
      fmt::format("{}: {} segments copied, {} rewritten, {} lost; {} models, {} lost; {} journals "
                  "with {} damaged places",
                  target, report.segments_copied, report.segments_rewritten, report.segments_lost,
                  report.models, report.models_lost, report.journals, report.damaged_places));
  print(report.has_loss() ? "Something was lost: see above." : "Nothing was lost.");
}

}  // namespace engram::reports
