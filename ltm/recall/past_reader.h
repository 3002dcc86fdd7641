// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <string>

#include "ltm/memory/result.h"
#include "ltm/recall/known_past.h"
#include "ltm/recall/model.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// The models of one store. Each is opened when it is first needed and stays open as long as this
/// object, or until clear(), so pointers to its parts stay valid.
///
/// Threading: one thread; counts may be read by others.
class LoadedModels {
 public:
  /// With an empty `loader` no model can be loaded.
  explicit LoadedModels(ModelLoader loader) : loader_(std::move(loader)) {}

  [[nodiscard]] bool has_loader() const { return loader_ != nullptr; }

  /// A model that is damaged or missing is tried once, and warned of.
  /// Errors: kFailedPrecondition without a loader; those of the loader.
  Result<const LoadedModel*> load(const std::filesystem::path& store, const ModelInfo& info);

  /// Closes all of them.
  void clear() {
    models_.clear();
    failed_.clear();
  }

  /// Models that are damaged or missing.
  [[nodiscard]] uint64_t damaged() const { return damaged_; }

  /// Counts a snapshot that was answered as it was recorded, because its latents are of no use.
  void note_substituted() { ++substituted_; }
  [[nodiscard]] uint64_t substituted() const { return substituted_; }

 private:
  ModelLoader loader_;
  std::map<std::string, LoadedModel> models_;  ///< The key is the model's file.
  std::map<std::string, Status> failed_;       ///< The same.
  std::atomic<uint64_t> damaged_{0};
  std::atomic<uint64_t> substituted_{0};
};

/// Whether data is damaged or gone, so that asking again would give the same.
[[nodiscard]] bool is_damage(const Status& status);

/// Reads snapshots of one generation of a store, from their recorded form or from their latents.
///
/// Threading: one thread.
class PastReader {
 public:
  /// `models` are those of the same store. They may have been loaded from an earlier generation.
  PastReader(std::unique_ptr<StoreReader> store, std::shared_ptr<LoadedModels> models)
      : store_(std::move(store)), models_(std::move(models)) {}

  [[nodiscard]] StoreReader& store() { return *store_; }

  /// Loads a model of the store's manifest. Errors: those of LoadedModels::load.
  Result<const LoadedModel*> load(const ModelInfo& info) {
    return models_->load(store_->path(), info);
  }

  /// Where latents are preferred and damaged, or their model is, what was recorded is the answer.
  /// Errors: kDataLoss; those of load().
  Result<SnapshotResult> read(const MemoryId& entity, const SnapshotEntry& entry, Prefer prefer);

  /// Returns the instances of a snapshot without their data, and the source that read() would use.
  Result<SnapshotResult> name(const MemoryId& entity, const SnapshotEntry& entry, Prefer prefer);

 private:
  Result<const ModelInfo*> find_model(const MemoryId& entity, int version) const;
  Result<SnapshotResult> read_recorded(const MemoryId& entity, const SnapshotEntry& entry);
  Result<SnapshotResult> reconstruct(const MemoryId& entity, const SnapshotEntry& entry);

  std::unique_ptr<StoreReader> store_;
  std::shared_ptr<LoadedModels> models_;
};

}  // namespace engram::ltm
