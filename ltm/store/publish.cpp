// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/publish.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <sstream>

#include "ltm/core/file.h"
#include "ltm/store/checksum.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_index.h"
#include "ltm/store/segment_reader.h"
#include "ltm/store/segment_writer.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

namespace {

/// Max attempts to publish. A live writer may seal a journal, which changes the generation, while
/// latents are being written.
constexpr int kPublishAttempts = 20;

/// The inverse of the escaping in model_file_name, or nullopt if `text` is not a valid result of
/// it.
std::optional<std::string> plain_name(std::string_view text) {
  if (text == "%") return std::string();
  std::string name;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      name += text[i];
      continue;
    }
    uint8_t byte = 0;
    const char* const last = text.data() + std::min(i + 3, text.size());
    const auto [end, error] = std::from_chars(text.data() + i + 1, last, byte, 16);
    if (error != std::errc() || end != text.data() + i + 3) return std::nullopt;
    name += static_cast<char>(byte);
    i += 2;
  }
  return name;
}

std::set<Time> times_of(const std::vector<LatentSnapshot>& snapshots) {
  std::set<Time> times;
  for (const LatentSnapshot& snapshot : snapshots) times.insert(snapshot.time);
  return times;
}

/// Latent segments of `entity` that contain only snapshots at `times`.
Result<std::set<std::string>> superseded_segments(const std::filesystem::path& store,
                                                  const Manifest& manifest, const MemoryId& entity,
                                                  const std::set<Time>& times) {
  std::set<std::string> files;
  for (const SegmentInfo& segment : manifest.segments) {
    if (segment.kind != SegmentKind::kLatent || segment.find(entity) == nullptr) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, SegmentReader::open(store / segment.file));
    ENGRAM_ASSIGN_OR_RETURN(const auto spans, reader->index(entity));
    const auto is_new = [&times](const RowSpan& span) { return times.contains(span.time); };
    if (std::ranges::all_of(spans, is_new)) files.insert(segment.file);
  }
  return files;
}

bool is_used(const ModelInfo& model, const Manifest& manifest) {
  return std::ranges::any_of(manifest.segments, [&model](const SegmentInfo& segment) {
    const SegmentEntity* entity = segment.find(model.entity);
    return entity != nullptr && segment.kind == SegmentKind::kLatent &&
           entity->latent.model_version == model.version;
  });
}

/// Checks that latents meet the conditions of publish_model.
Status check_latents(const MemoryId& entity, int version,
                     const std::vector<LatentSnapshot>& snapshots) {
  const std::string name = ModelInfo{entity, version, "", 0, 0}.name();
  if (!entity.is_entity())
    return invalid_argument("model {}: '{}' is no entity", name, entity.to_string());
  // A model without latents would be removed at once.
  if (snapshots.empty()) return invalid_argument("model {}: there are no latents of it", name);
  for (size_t i = 0; i < snapshots.size(); ++i) {
    if (snapshots[i].model_version != version)
      return invalid_argument("model {}: found latents of v{}", name, snapshots[i].model_version);
    if (snapshots[i].instances.empty())
      return invalid_argument("model {}: the latents at {} have no instances", name,
                              to_string(snapshots[i].time));
    if (i > 0 && snapshots[i].time <= snapshots[i - 1].time)
      return invalid_argument("model {}: latents run backwards in time at {}", name,
                              to_string(snapshots[i].time));
  }
  return {};
}

/// Keeps the snapshots whose recorded form is still the one from which the latents were made.
Result<std::vector<LatentSnapshot>> still_there(StoreReader& reader, const MemoryId& entity,
                                                const std::vector<LatentSnapshot>& snapshots,
                                                uint64_t first_unseen_journal) {
  std::vector<LatentSnapshot> kept;
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, reader.timeline(entity));
  for (const LatentSnapshot& snapshot : snapshots) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(snapshot.time));
    if (!entry || entry->time != snapshot.time) continue;
    const auto& recorded = entry->recorded;
    // Unsealed data will be sealed into a later segment than these latents and then supersedes
    // them.
    if (recorded && recorded->rows == 0) continue;
    if (recorded &&
        reader.manifest().segments[recorded->source].last_journal >= first_unseen_journal)
      continue;
    kept.push_back(snapshot);
  }
  if (!kept.empty()) return kept;
  return failed_precondition(
      "entity '{}': of {} snapshots none is as it was when the model was made: they were "
      "forgotten, "
      "recorded anew, or joined with newer ones by compaction; train again",
      entity.to_string(), snapshots.size());
}

/// Checks whether the manifest can take latents of `model`. `is_new` says that the model file is
/// published too.
Status check_model(const std::filesystem::path& store, const Manifest& manifest,
                   const ModelInfo& model, bool is_new) {
  if (is_new && next_model_version(manifest, model.entity) > model.version)
    return already_exists("store '{}': model {} exists", store.string(), model.name());
  const bool is_there = std::ranges::any_of(manifest.models, [&](const ModelInfo& there) {
    return there.entity == model.entity && there.version == model.version;
  });
  if (!is_new && !is_there)
    return not_found("store '{}': has no model {}", store.string(), model.name());
  return {};
}

/// Publishes the latents, and the model if it has a file, provided the manifest is still of
/// `generation`. Returns false without any change if it is not.
Result<bool> publish_once(const std::filesystem::path& store, uint64_t generation,
                          const ModelInfo& model,
                          const std::optional<std::filesystem::path>& model_file,
                          const std::vector<LatentSnapshot>& snapshots) {
  ENGRAM_ASSIGN_OR_RETURN(const TemporaryFile file, TemporaryFile::create(store, ".h5"));
  ENGRAM_ASSIGN_OR_RETURN(SegmentInfo segment,
                          write_latent_segment(file.path(), model.entity, snapshots));
  std::vector<std::string> obsolete;
  bool has_changed = false;
  const Status status = edit_manifest(store, [&](Manifest& manifest) -> Status {
    has_changed = manifest.generation != generation;
    // The kept snapshots were selected in `generation`. In a newer one some may have been forgotten
    // or updated, so the selection must be repeated.
    if (has_changed) return cancelled("store '{}' has changed", store.string());
    ENGRAM_RETURN_IF_ERROR(check_model(store, manifest, model, model_file.has_value()));
    ENGRAM_ASSIGN_OR_RETURN(
        const auto superseded,
        superseded_segments(store, manifest, model.entity, times_of(snapshots)));
    segment.file = fmt::format("segments/{:06}.h5", manifest.next_segment++);
    if (model_file) ENGRAM_RETURN_IF_ERROR(publish_file(*model_file, store / model.file));
    ENGRAM_RETURN_IF_ERROR(publish_file(file.path(), store / segment.file));
    std::erase_if(manifest.segments,
                  [&](const SegmentInfo& old) { return superseded.contains(old.file); });
    manifest.segments.push_back(std::move(segment));
    if (model_file) manifest.models.push_back(model);
    obsolete = remove_unused_models(manifest, std::vector(superseded.begin(), superseded.end()));
    return {};
  });
  if (has_changed) return false;
  ENGRAM_RETURN_IF_ERROR(status);
  ENGRAM_RETURN_IF_ERROR(remove_published(store, obsolete));
  return true;
}

Status publish(const std::filesystem::path& store, const ModelInfo& model,
               const std::optional<std::filesystem::path>& model_file,
               const std::vector<LatentSnapshot>& snapshots, uint64_t first_unseen_journal) {
  for (int attempt = 0; attempt < kPublishAttempts; ++attempt) {
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
    ENGRAM_ASSIGN_OR_RETURN(const auto kept,
                            still_there(*reader, model.entity, snapshots, first_unseen_journal));
    ENGRAM_ASSIGN_OR_RETURN(
        const bool is_published,
        publish_once(store, reader->manifest().generation, model, model_file, kept));
    if (is_published) return {};
  }
  return unavailable("store '{}': changed {} times while latents of {} were being published",
                     store.string(), kPublishAttempts, model.name());
}

}  // namespace

int next_model_version(const Manifest& manifest, const MemoryId& entity) {
  const ModelInfo* newest = manifest.newest_model(entity);
  return newest == nullptr ? 1 : newest->version + 1;
}

std::vector<std::string> remove_unused_models(Manifest& manifest,
                                              std::vector<std::string> obsolete) {
  std::erase_if(manifest.models, [&](const ModelInfo& model) {
    if (is_used(model, manifest)) return false;
    obsolete.push_back(model.file);
    return true;
  });
  return obsolete;
}

std::string entity_file_prefix(const MemoryId& entity) {
  std::string name;
  for (const std::string& part : entity.names()) {
    // Escape dots inside a name, because a dot separates the names.
    for (const char c : segment_name(part)) name += c == '.' ? "%2E" : std::string(1, c);
    name += '.';
  }
  return name;
}

std::string model_file_name(const MemoryId& entity, int version) {
  return fmt::format("models/{}v{}.h5", entity_file_prefix(entity), version);
}

std::optional<ModelInfo> model_of_file(const std::string& file) {
  std::vector<std::string> parts;
  std::istringstream stream(std::filesystem::path(file).filename().string());
  for (std::string part; std::getline(stream, part, '.');) parts.push_back(std::move(part));
  if (parts.size() != MemoryId::kNameLevels + 2) return std::nullopt;
  std::vector<std::string> names;
  for (size_t i = 0; i < MemoryId::kNameLevels; ++i) {
    const auto name = plain_name(parts[i]);
    if (!name) return std::nullopt;
    names.push_back(*name);
  }
  const auto entity = MemoryId::from_names(std::move(names));
  const std::string& version = parts[MemoryId::kNameLevels];
  ModelInfo model;
  if (!entity.ok() || version.size() < 2) return std::nullopt;
  std::from_chars(version.data() + 1, version.data() + version.size(), model.version);
  model.entity = *entity;
  model.file = model_file_name(*entity, model.version);
  if (model.version < 1 || model.file != file) return std::nullopt;
  return model;
}

Status publish_model(const std::filesystem::path& store, const MemoryId& entity, int version,
                     const std::filesystem::path& model_file,
                     const std::vector<LatentSnapshot>& snapshots, uint64_t first_unseen_journal) {
  ENGRAM_RETURN_IF_ERROR(check_latents(entity, version, snapshots));
  ModelInfo model{entity, version, model_file_name(entity, version), 0, 0};
  ENGRAM_ASSIGN_OR_RETURN(model.checksum, checksum_of_file(model_file));
  model.bytes = std::filesystem::file_size(model_file);
  return publish(store, model, model_file, snapshots, first_unseen_journal);
}

Status publish_latents(const std::filesystem::path& store, const MemoryId& entity, int version,
                       const std::vector<LatentSnapshot>& snapshots,
                       uint64_t first_unseen_journal) {
  ENGRAM_RETURN_IF_ERROR(check_latents(entity, version, snapshots));
  return publish(store, {entity, version, model_file_name(entity, version), 0, 0}, {}, snapshots,
                 first_unseen_journal);
}

}  // namespace engram::ltm
