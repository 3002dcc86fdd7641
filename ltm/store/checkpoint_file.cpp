// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/checkpoint_file.h"

#include <algorithm>

#include "ltm/core/file.h"
#include "ltm/store/publish.h"

namespace engram::ltm {

namespace {

constexpr std::string_view kSuffix = ".checkpoint";
/// Suffix of a checkpoint that is still being written.
constexpr std::string_view kUnfinished = ".checkpoint.new";

constexpr std::string_view kHistory = ".history";

bool is_of_checkpoint(const std::string& name) {
  return is_checkpoint(name) || name.ends_with(kUnfinished);
}

std::vector<std::filesystem::path> temporary_files(const std::filesystem::path& store) {
  std::vector<std::filesystem::path> files;
  std::error_code missing;
  for (const auto& entry : std::filesystem::directory_iterator(store / "tmp", missing))
    files.push_back(entry.path());
  return files;
}

}  // namespace

std::filesystem::path checkpoint_file(const std::filesystem::path& store, const MemoryId& entity,
                                      uint64_t key) {
  return store / "tmp" / fmt::format("{}{:016x}{}", entity_file_prefix(entity), key, kSuffix);
}

std::filesystem::path history_file(const std::filesystem::path& store, const MemoryId& entity) {
  std::string name = entity_file_prefix(entity);
  name.pop_back();
  return store / "tmp" / (name + std::string(kHistory));
}

bool is_checkpoint(const std::string& name) {
  return name.ends_with(kSuffix);
}

bool is_checkpoint_of(const std::string& name, const MemoryId& entity) {
  return is_of_checkpoint(name) && name.starts_with(entity_file_prefix(entity));
}

bool is_history(const std::string& name) {
  return name.ends_with(kHistory);
}

Status remove_checkpoints(const std::filesystem::path& store, const MemoryId& entity,
                          std::span<const std::filesystem::path> kept) {
  for (const auto& file : temporary_files(store)) {
    const std::string name = file.filename().string();
    if (is_checkpoint_of(name, entity) && std::ranges::find(kept, file) == kept.end())
      ENGRAM_RETURN_IF_ERROR(remove_file(file));
  }
  return {};
}

Status remove_checkpoints_of_others(const std::filesystem::path& store,
                                    const std::vector<MemoryId>& entities) {
  for (const auto& file : temporary_files(store)) {
    const std::string name = file.filename().string();
    if (!is_of_checkpoint(name) && !is_history(name)) continue;
    const bool is_known = std::ranges::any_of(entities, [&](const MemoryId& entity) {
      return name.starts_with(entity_file_prefix(entity));
    });
    if (!is_known) ENGRAM_RETURN_IF_ERROR(remove_file(file));
  }
  return {};
}

}  // namespace engram::ltm
