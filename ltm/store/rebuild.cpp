// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/rebuild.h"

#include <algorithm>

#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/store/checksum.h"
#include "ltm/store/publish.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_walk.h"

namespace engram::ltm {

namespace {

Result<std::vector<std::string>> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  // Some copies of a store omit empty folders.
  if (!std::filesystem::exists(folder, error)) return names;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    names.push_back(entry.path().filename().string());
  if (error) return unavailable("'{}': {}", folder.string(), error.message());
  std::ranges::sort(names);
  return names;
}

Finding lost(const std::string& file, const Status& why) {
  return {Severity::kFault, file, "", why.message(), "none: what it held is lost"};
}

/// Adds the types stored in a segment. Later segments take precedence.
void add_types(const std::filesystem::path& file, SegmentTypes& types) {
  const auto reader = SegmentReader::open(file);
  if (!reader.ok()) return;
  const auto found = (*reader)->types();
  if (!found.ok()) return;
  for (const auto& [segment, type] : found->all()) {
    // A type that contradicts the known ones stays in its segment only.
    if (const Status declared = types.declare(segment, type); !declared.ok())
      log::warning("'{}': its type of '{}' is not the store's: {}", file.string(),
                   segment.to_string(), declared.message());
  }
}

Status add_segment(const std::filesystem::path& store, const std::string& file,
                   RebuiltManifest& result) {
  auto described = describe_segment(store / file);
  if (described.status().code() == StatusCode::kFailedPrecondition ||
      described.status().code() == StatusCode::kUnavailable)
    return described.status();
  if (!described.ok()) {
    ++result.unreadable;
    result.findings.push_back(lost(file, described.status()));
    return {};
  }
  for (const Status& damage : described->damaged) result.findings.push_back(lost(file, damage));
  if (!described->is_whole) result.damaged.push_back(file);
  described->info.file = file;
  result.manifest.segments.push_back(std::move(described->info));
  add_types(store / file, result.manifest.types);
  return {};
}

Status add_segments(const std::filesystem::path& store, RebuiltManifest& result) {
  ENGRAM_ASSIGN_OR_RETURN(auto names, names_in(store / "segments"));
  std::erase_if(names, [](const std::string& name) { return segment_number(name) == 0; });
  std::ranges::stable_sort(names, {}, segment_number);
  for (const std::string& name : names) {
    ENGRAM_RETURN_IF_ERROR(add_segment(store, "segments/" + name, result));
    result.manifest.next_segment = segment_number(name) + 1;
  }
  return {};
}

Status add_models(const std::filesystem::path& store, RebuiltManifest& result) {
  ENGRAM_ASSIGN_OR_RETURN(const auto names, names_in(store / "models"));
  for (const std::string& name : names) {
    auto model = model_of_file("models/" + name);
    if (!model) continue;
    ENGRAM_ASSIGN_OR_RETURN(model->checksum, checksum_of_file(store / model->file));
    ENGRAM_ASSIGN_OR_RETURN(const File file, File::open(store / model->file, File::Mode::kRead));
    ENGRAM_ASSIGN_OR_RETURN(model->bytes, file.size());
    result.manifest.models.push_back(std::move(*model));
  }
  return {};
}

}  // namespace

Result<RebuiltManifest> rebuild_manifest(const std::filesystem::path& store) {
  RebuiltManifest result;
  ENGRAM_RETURN_IF_ERROR(add_segments(store, result));
  ENGRAM_RETURN_IF_ERROR(add_models(store, result));
  return result;
}

}  // namespace engram::ltm
