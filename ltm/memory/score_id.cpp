// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/score_id.h"

namespace engram::ltm {

MemoryId score_id(const MemoryId& predicted) {
  return *MemoryId::from_names({"SystemState", "Replay", "scores", predicted.entity().to_string()});
}

std::optional<MemoryId> scored_entity(const MemoryId& entity) {
  const auto& names = entity.names();
  if (names.size() != 4 || names[0] != "SystemState" || names[1] != "Replay" ||
      names[2] != "scores")
    return std::nullopt;
  const auto scored = MemoryId::parse(names[3]);
  return scored.ok() ? std::optional(*scored) : std::nullopt;
}

}  // namespace engram::ltm
