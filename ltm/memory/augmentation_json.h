// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// {"origin": "<memory ID>", "recipe": {...}}: what JSON forms of an instance say beside its other
/// metadata; an empty object where it is not augmented. A recipe that is no JSON is a string.
[[nodiscard]] nlohmann::ordered_json augmentation_json(const InstanceMetadata& metadata);

/// Reads what augmentation_json wrote, out of an object that may have other keys too.
/// Errors: kInvalidArgument naming the key, what was found and what was needed.
Status read_augmentation(const nlohmann::ordered_json& json, InstanceMetadata& metadata);

}  // namespace engram::ltm
