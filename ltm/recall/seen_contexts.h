// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what conditions of a query know of other entities.

#include <map>
#include <optional>
#include <vector>

#include "ltm/context/meet_conditions.h"
#include "ltm/recall/list_moments.h"

namespace engram::ltm {

/// The contexts of the entities of a past, as one view sees them. Each is gathered once.
///
/// Threading: one thread. It shows the past as it was when an entity was asked for first, so it
/// lives for one question.
class SeenContexts final : public KnownContexts {
 public:
  SeenContexts(KnownPast& past, SeenPastOf seen, std::shared_ptr<const OtherContexts> others = {})
      : past_(past), seen_(std::move(seen)), others_(std::move(others)) {}

  /// Gathers the context of an entity from a past of it that is there already.
  Status gather(const MemoryId& entity, EntityPast& own);

  Result<std::shared_ptr<const EntityContext>> of(const MemoryId& entity) override;
  Result<std::optional<Intrinsics>> intrinsics(const MemoryId& link) override;
  Result<bool> has_depths(const MemoryId& camera) override;
  Result<std::optional<bool>> is_hidden(const MemoryId& image, double x, double y,
                                        double z) override;

 private:
  /// Finds the entities with depth images that link to images of a camera, once for each.
  Result<const std::vector<MemoryId>*> depths_of(const MemoryId& camera);

  KnownPast& past_;
  const SeenPastOf seen_;
  const std::shared_ptr<const OtherContexts> others_;  ///< May be null.
  std::map<MemoryId, SharedContext> contexts_;
  std::map<MemoryId, std::vector<MemoryId>> depths_;  ///< By camera.
};

}  // namespace engram::ltm
