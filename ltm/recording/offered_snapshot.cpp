// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/offered_snapshot.h"

namespace engram::ltm {

void OfferedSnapshot::redact(Redactor& redactor) {
  if (!redactor.applies_to(given->entity)) return;
  if (!cast) cast = *given;
  redaction = redactor.redact(*cast);
  // They still hold what must not be kept.
  redaction.originals.clear();
}

Result<OfferedSnapshot> OfferedSnapshot::of(const Snapshot& update, const SegmentTypes& types) {
  OfferedSnapshot offered{.given = &update};
  for (size_t i = 0; i < update.instances.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(auto cast, types.cast_misfit(update.entity, update.instances[i].data));
    if (!cast) continue;
    if (!offered.cast) offered.cast = update;
    offered.cast->instances[i].data = std::move(cast->value);
    if (!cast->notes.empty()) offered.notes.push_back(cast->notes.front().to_string());
  }
  offered.raw_bytes = offered.snapshot().raw_bytes();
  return offered;
}

Result<OfferedSnapshot> OfferedSnapshot::of(const CheckedSnapshot& update,
                                            const SegmentTypes& types) {
  if (update.is_of(types))
    return OfferedSnapshot{.given = &update, .raw_bytes = update.raw_bytes(), .is_redacted = true};
  ENGRAM_ASSIGN_OR_RETURN(OfferedSnapshot offered, of(static_cast<const Snapshot&>(update), types));
  offered.is_redacted = !offered.cast;
  return offered;
}

}  // namespace engram::ltm
