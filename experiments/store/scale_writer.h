// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "store/scale_object.h"

namespace engram::experiments {

/// Records the whole world through the recorder, as fast as possible, into `store`, which is made
/// new. Returns seconds until closed, snapshots per second, bytes on disk, and peak memory.
/// Errors: those of Recorder.
Result<nlohmann::json> write_scale(const ScaleWorld& world, const std::filesystem::path& store);

}  // namespace engram::experiments
