// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ltm/store/latent.h"
#include "ltm/store/manifest.h"
#include "ltm/store/temporary_file.h"

namespace engram::ltm {

/// The version number that the next model of `entity` gets. Versions start at 1.
[[nodiscard]] int next_model_version(const Manifest& manifest, const MemoryId& entity);

/// Removes models that no latent uses from the manifest. Returns `obsolete` plus the files of these
/// models; the caller removes those files once the manifest is published.
[[nodiscard]] std::vector<std::string> remove_unused_models(Manifest& manifest,
                                                            std::vector<std::string> obsolete);

/// The path of a model relative to the store: "models/Vision.RGB.head.cam.v2.h5".
[[nodiscard]] std::string model_file_name(const MemoryId& entity, int version);
/// What the names of all files of an entity begin with: "Vision.RGB.head.cam.".
[[nodiscard]] std::string entity_file_prefix(const MemoryId& entity);
/// The inverse of model_file_name: entity, version and file, or nullopt if `file` is not the name
/// of a model.
[[nodiscard]] std::optional<ModelInfo> model_of_file(const std::string& file);

/// Publishes a new model of an entity together with the latents that it made, in one generation.
/// Older latents of the same times are superseded, and models that no latent uses any more are
/// removed.
///
/// `model_file` is moved into the store. `snapshots` must increase in time and all have version
/// `version`. They were made from the data that journals before `first_unseen_journal` had sealed
/// (Manifest::first_journal of the generation that was read). Latents of snapshots that were
/// forgotten or recorded again since then are left out. A block that keeps some of its rows is
/// stored with all its bytes.
/// If compaction meanwhile joined one of the segments that were read with a newer one, the latents
/// of that segment are left out too, because its updated snapshots can no longer be identified. Run
/// compaction before or after training, not during it.
/// Errors: kAlreadyExists if the version exists; kInvalidArgument if `snapshots` are empty, do not
/// meet the conditions above, or have a place that is not valid in a block; kFailedPrecondition if
/// no snapshot remains; kNotFound if `model_file` does not exist; kUnavailable, kResourceExhausted.
/// Threading: may run beside a live writer.
Status publish_model(const std::filesystem::path& store, const MemoryId& entity, int version,
                     const std::filesystem::path& model_file,
                     const std::vector<LatentSnapshot>& snapshots,
                     uint64_t first_unseen_journal = UINT64_MAX);

/// Publishes more latents of a model that is in the store, in one generation. Otherwise it works
/// like publish_model.
/// Errors: kNotFound if the store has no model of that version; those of publish_model.
/// Threading: may run beside a live writer.
Status publish_latents(const std::filesystem::path& store, const MemoryId& entity, int version,
                       const std::vector<LatentSnapshot>& snapshots,
                       uint64_t first_unseen_journal = UINT64_MAX);

}  // namespace engram::ltm
