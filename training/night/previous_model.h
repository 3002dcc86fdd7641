// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "training/night/choose_form.h"
#include "training/night/entity_work.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::encoders {
struct DeepModel;
}

namespace engram::training {

/// Bytes of a snapshot's latents: its share of its blocks, and its remainder.
[[nodiscard]] double bytes_of(const ltm::LatentSnapshot& snapshot);

/// A note that the newest model was not compared, and why.
[[nodiscard]] std::string not_compared(const ltm::ModelInfo& newest, std::string_view why);

/// Returns the newest model if it can encode these snapshots with the requested options; else null,
/// with a note.
[[nodiscard]] std::shared_ptr<encoders::DeepModel> usable_model(const EntityWork& work,
                                                                const PlannedEntity& planned,
                                                                const ChosenForm& form,
                                                                const ltm::ModelInfo& newest,
                                                                std::vector<std::string>& notes);

/// Returns the newest model if a night of video alone should go on with it, because a new model
/// would be no better: nothing is trained, as there are images alone, and it has the same bound and
/// chains. Else null.
[[nodiscard]] std::shared_ptr<encoders::DeepModel> model_of_more_video(const EntityWork& work,
                                                                       const PlannedEntity& planned,
                                                                       const ChosenForm& form);

/// Bytes of the newest model's latents of a snapshot; nothing if it has none within the bound.
/// Errors: the errors of the store.
Result<std::optional<double>> known_bytes(const EntityWork& work, const PlannedEntity& planned,
                                          const encoders::DeepModel& newest,
                                          const ltm::SnapshotEntry& entry);

}  // namespace engram::training
