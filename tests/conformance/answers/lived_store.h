// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/memory/commit.h"
#include "ltm/recall/model.h"

namespace engram::testing {

/// Makes a store as a robot has it after some nights, which has an entity of every kind that
/// answers are known to differ about:
///
/// * `Vision/RGB/head/cam`: 60 snapshots at 5 Hz, the first half as latents alone, some in both
///   forms, and a model that predicts;
/// * `Vision/RGB/head/damaged`: the same, but latents of its past cannot be decoded;
/// * `Vision/RGB/head/led`: its model starts from `Robot/State/arm/broken` too, of which only the
///   newest snapshot can be read;
/// * `Robot/State/arm/joints`: numbers that move, two instances;
/// * `Robot/State/arm/forgotten`: of 30 snapshots the middle ones were forgotten;
/// * `Objects/Things/kitchen/cup`: one snapshot long ago.
///
/// Errors: those of making it.
Status make_lived_store(const std::filesystem::path& store);

/// What came today, in the order of time: what goes on (`cam`, `joints`, `led`), one entity that is
/// nowhere else (`Speech/Commands/human/text`), and a snapshot later than all others of `cup`.
std::vector<ltm::Commit> commits_of_today();

/// Opens the models of that store. Threading: thread-safe.
ltm::ModelLoader lived_models();

}  // namespace engram::testing
