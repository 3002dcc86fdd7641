// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: how single conditions are met.

#include <vector>

#include "ltm/context/meet_conditions.h"

namespace engram::ltm {

/// Which snapshots of an entity meet a condition: one byte for each, 1 if it does.
using Met = std::vector<uint8_t>;

/// The entity that is asked.
struct Asked {
  const MemoryId& id;
  const EntityContext& context;
  bool is_named = false;
};

Result<Met> meet_near(const Asked& asked, const where::Near& near);
Result<Met> meet_within(const Asked& asked, const where::Within& within,
                        const EntityContext& other);
Result<Met> meet_view(const Asked& asked, const where::InView& view, const EntityContext& other,
                      KnownContexts& contexts);

/// Why an entity has no place in a frame: it has none at all, or poses that name no frame.
[[nodiscard]] Status no_place(const MemoryId& entity, const EntityContext& context,
                              std::string_view frame);

/// The frames of an entity, for messages: "'world', 'map'".
[[nodiscard]] std::string frames_of(const EntityContext& context);

}  // namespace engram::ltm
