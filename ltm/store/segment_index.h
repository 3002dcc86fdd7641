// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/store/finding.h"
#include "ltm/store/manifest.h"

namespace engram::ltm {

/// Where a store has its indexes.
inline constexpr const char* kIndexFolder = "indexes";

/// Indexes are what was computed from published segments so that questions are answered quickly.
/// They can be made again, so no manifest names them, and a store without them has lost nothing.
/// What an index tells of a snapshot must go with the snapshot: each belongs to one segment file,
/// by its checksum, and is removed with it.
///
/// A `kind` names what is computed, in lower-case letters: "codes". Files are
/// "indexes/000012.codes", or "indexes/Vision.RGB.head.cam.space" for what belongs to an entity.
/// Source: docs/format.md, section "Indexes".

/// The index of a segment: "indexes/000012.codes", relative to the store.
[[nodiscard]] std::string segment_index_name(const std::string& segment_file,
                                             std::string_view kind);

/// The index of an entity, relative to the store.
[[nodiscard]] std::string entity_index_name(const MemoryId& entity, std::string_view kind);

/// The content of a segment's index.
/// Errors: kNotFound if there is none, or if it belongs to another segment file of this name;
/// kDataLoss if it is damaged; kUnavailable.
Result<Buffer> read_segment_index(const std::filesystem::path& store, const SegmentInfo& segment,
                                  std::string_view kind);

/// Makes the new content of an index from the one that is there, which is empty if there is none
/// or if it is damaged.
using EditIndex = std::function<std::vector<std::byte>(std::span<const std::byte> there)>;

/// Writes the index of a segment. Nobody else edits it meanwhile.
/// Errors: kNotFound if the store no longer has this segment: then nothing is written, so that what
/// was forgotten meanwhile does not come back; kUnavailable, kResourceExhausted.
/// Threading: may run beside a live writer and beside readers.
Status edit_segment_index(const std::filesystem::path& store, const SegmentInfo& segment,
                          std::string_view kind, const EditIndex& edit);

/// The content of an entity's index. Errors: kNotFound, kDataLoss, kUnavailable.
Result<Buffer> read_entity_index(const std::filesystem::path& store, const MemoryId& entity,
                                 std::string_view kind);

/// Writes the index of an entity, or replaces it. `was_made_of` is the manifest that it was made
/// of.
/// Errors: kFailedPrecondition if snapshots of the entity were forgotten since then, because it
/// could still tell of them; kUnavailable, kResourceExhausted.
Status publish_entity_index(const std::filesystem::path& store, const Manifest& was_made_of,
                            const MemoryId& entity, std::string_view kind,
                            std::span<const std::byte> content);

/// Removes all indexes of an entity: what it was made of is erased. Returns the names of the files,
/// relative to the store.
/// Errors: kUnavailable.
Result<std::vector<std::string>> remove_entity_indexes(const std::filesystem::path& store,
                                                       const MemoryId& entity);

/// Removes the indexes of entities that were made before anything of their entity was forgotten: as
/// models, they stay until somebody erases. Returns their names as above.
/// Errors: those of read_manifest; kUnavailable.
Result<std::vector<std::string>> remove_outdated_entity_indexes(const std::filesystem::path& store);

/// Removes published files that a manifest no longer names. Indexes of segments go before them, so
/// that none outlives what it tells of. `files` are relative to the store.
/// Errors: kUnavailable.
Status remove_published(const std::filesystem::path& store, const std::vector<std::string>& files);

/// The files in the index folder that belong to no segment of the manifest, relative to the store:
/// a killed process left them.
[[nodiscard]] std::vector<std::string> find_stray_indexes(const std::filesystem::path& store,
                                                          const Manifest& manifest);

/// Copies the indexes of `source` that are whole and belong to a segment or an entity of `target`,
/// whose manifest is given.
/// Errors: kUnavailable, kResourceExhausted.
Status copy_indexes(const std::filesystem::path& source, const std::filesystem::path& target,
                    const Manifest& manifest);

/// Verifies the checksums of all indexes, and returns a note for each that is damaged.
[[nodiscard]] std::vector<Finding> check_indexes(const std::filesystem::path& store,
                                                 const Manifest& manifest);

}  // namespace engram::ltm
