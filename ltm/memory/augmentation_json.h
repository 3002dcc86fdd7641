// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// Returns {"origin": "<memory ID>", "recipe": {...}}, the keys that JSON forms of an instance add
/// to its other metadata; an empty object where it is not augmented. A recipe that is no JSON
/// becomes a string.
[[nodiscard]] nlohmann::ordered_json augmentation_json(const InstanceMetadata& metadata);

/// Reads what augmentation_json wrote, from an object that may have other keys too.
/// Errors: kInvalidArgument naming the key, what was found and what was needed.
Status read_augmentation(const nlohmann::ordered_json& json, InstanceMetadata& metadata);

}  // namespace engram::ltm
