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

/// The version that the next model of `entity` gets: 1, 2, ...
[[nodiscard]] int next_model_version(const Manifest& manifest, const MemoryId& entity);

/// Takes models that no latent names any more out of the manifest, and adds their files to those
/// that may be removed once it is published.
[[nodiscard]] std::vector<std::string> remove_unused_models(Manifest& manifest,
                                                            std::vector<std::string> obsolete);

/// Where a model lies in a store, and back: "models/Vision.RGB.head.cam.v2.h5".
[[nodiscard]] std::string model_file_name(const MemoryId& entity, int version);
/// Entity, version and file; nothing where the name is not of a model.
[[nodiscard]] std::optional<ModelInfo> model_of_file(const std::string& file);

/// Publishes a new model of an entity together with the latents that it made, in one generation.
/// Older latents of the same times are superseded; models that no latent names any more go.
///
/// `model_file` is moved into the store. `snapshots` increase in time, all of version `version`.
/// They were made of what journals before `first_unseen_journal` had sealed
/// (Manifest::first_journal of the generation that was read): latents of what was forgotten since
/// then, or recorded anew, are left out; a block of which some stay is stored with all its bytes.
/// So are those of a segment that compaction joined meanwhile with one that is newer: what in it
/// was recorded anew cannot be told any more. Compact before training or after it.
/// Errors: kAlreadyExists where the version is taken; kInvalidArgument where `snapshots` are empty
/// or not as said, or have places that no block can have; kFailedPrecondition where none of them is
/// left; kNotFound where there is no `model_file`; kUnavailable, kResourceExhausted.
/// Threading: runs beside a live writer.
Status publish_model(const std::filesystem::path& store, const MemoryId& entity, int version,
                     const std::filesystem::path& model_file,
                     const std::vector<LatentSnapshot>& snapshots,
                     uint64_t first_unseen_journal = UINT64_MAX);

/// Publishes more latents of a model that the store has, in one generation. Else as publish_model.
/// Errors: kNotFound where the store has no model of that version; else those of publish_model.
/// Threading: runs beside a live writer.
Status publish_latents(const std::filesystem::path& store, const MemoryId& entity, int version,
                       const std::vector<LatentSnapshot>& snapshots,
                       uint64_t first_unseen_journal = UINT64_MAX);

}  // namespace engram::ltm
