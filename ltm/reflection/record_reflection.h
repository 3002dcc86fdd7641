// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/type.h"
#include "ltm/memory/commit.h"
#include "ltm/reflection/reflection.h"

namespace engram::ltm {

/// The types of what a reflection becomes: provider segments of the memory Reflection.
[[nodiscard]] std::vector<std::pair<MemoryId, idf::Type>> reflection_types();

/// A reflection as snapshots of one time: Reflection/Findings/engram/all, and
/// Reflection/Summary/{entities,skills,chains}/all. Each finding, entity, rate and chain is an
/// instance. Findings link to the first and the last snapshot that they mean. If nothing was found,
/// there is one instance of kind "none", so that the latest reflection never is an old one.
[[nodiscard]] Commit to_commit(const Reflection& reflection, Time time);

/// Records a reflection into a store, so that the store can be asked about it.
/// Errors: those of Recorder::open, declare and commit.
Status record_reflection(const std::filesystem::path& store, const Reflection& reflection,
                         const Clock& clock = system_now);

}  // namespace engram::ltm
