// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ltm/context/entity_context.h"
#include "ltm/memory/snapshot_condition.h"

namespace engram::ltm {

/// The contexts of entities, as far as who asks may see them.
///
/// Threading: one thread.
class KnownContexts {
 public:
  virtual ~KnownContexts() = default;

  /// Null if there is no such entity.
  /// Errors: those of the past.
  virtual Result<std::shared_ptr<const EntityContext>> of(const MemoryId& entity) = 0;

  /// The intrinsics behind a link; nothing if nothing is there or it has none.
  /// Errors: those of the past.
  virtual Result<std::optional<Intrinsics>> intrinsics(const MemoryId& link) = 0;

  /// Whether there are depth images that link to images of a camera.
  /// Errors: those of the past.
  virtual Result<bool> has_depths(const MemoryId& camera) = 0;

  /// Whether something is certainly before a point of a camera's image, as depth images say that
  /// link to the camera's image. Nothing where there is no such image, or where it measured
  /// nothing. `x` and `y` are 0 at the left and the top of the image and 1 at its other sides; `z`
  /// is along the optical axis, in m.
  /// Errors: those of the past.
  virtual Result<std::optional<bool>> is_hidden(const MemoryId& image, double x, double y,
                                                double z) = 0;
};

/// Detectors may skip images. Where only links tell what was seen, a snapshot so close to an image
/// that links to the camera means that it was seen.
inline constexpr Duration kSeenTolerance = std::chrono::seconds(1);

/// The moments of an entity that meet all conditions, increasing. `is_named`: the entity was asked
/// for by its name, so that one without places is an error, and does not just meet nothing.
/// Errors: kNotFound if there is no entity that a condition names; kFailedPrecondition if a
/// condition needs a place, a frame, a camera or a span that it does not have; those of `contexts`.
/// Complexity: O(n) in the snapshots of the entities.
/// Source: docs/query.md, "Places" and "Context".
Result<std::vector<Time>> moments_meeting(const MemoryId& entity,
                                          std::span<const Condition> conditions, bool is_named,
                                          KnownContexts& contexts);

}  // namespace engram::ltm
