// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/redaction_report.h"

#include "reports/plain/text.h"

namespace engram::reports {

void print_redaction(const ltm::StoreRedaction& report, bool is_dry_run) {
  TextTable table(
      {"entity", "looked at", "redacted", "boxes", "dropped", "no answer", "unreadable"});
  for (const auto& [id, entity] : report.entities)
    if (entity.boxes + entity.redacted + entity.dropped + entity.unanswered + entity.unreadable > 0)
      table.add({id.printable(), count_text(entity.looked_at), count_text(entity.redacted),
                 count_text(entity.boxes), count_text(entity.dropped),
                 count_text(entity.unanswered), count_text(entity.unreadable)});
  const ltm::EntityRedaction total = report.total();
  if (total.boxes + total.redacted + total.dropped + total.unanswered + total.unreadable > 0)
    print(table.to_string());
  print(fmt::format("{}: {} snapshots looked at, {} redacted, {} dropped",
                    is_dry_run ? "would be" : "done", count_text(total.looked_at),
                    count_text(total.redacted), count_text(total.dropped)));
  if (report.taken_up > 0)
    print(fmt::format("an earlier run that was cut off began with {} of these snapshots",
                      count_text(report.taken_up)));
  if (report.made_of > 0)
    print(fmt::format("{} augmented snapshots that were made of them went, too",
                      count_text(report.made_of)));
  if (!report.erased) return;
  for (const auto& [id, entity] : report.erased->entities) {
    if (entity.recoded + entity.uncoded > 0)
      print(fmt::format("{}: {} other snapshots were coded anew, {} wait for the next night",
                        id.printable(), count_text(entity.recoded), count_text(entity.uncoded)));
    for (const std::string& model : entity.models)
      print(fmt::format("{}: model {} had learned from originals and is gone", id.printable(),
                        model));
  }
  print(fmt::format("store: {} before, {} after; report: {}",
                    bytes_text(static_cast<double>(report.bytes_before)),
                    bytes_text(static_cast<double>(report.bytes_after)), report.erased->report));
}

}  // namespace engram::reports
