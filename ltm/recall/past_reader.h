// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>

#include "ltm/memory/result.h"
#include "ltm/recall/known_past.h"
#include "ltm/recall/model.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// The models of one store. Each is opened when it is first needed and stays open as long as this
/// object, so pointers to its parts stay valid.
///
/// Threading: one thread.
class LoadedModels {
 public:
  /// With an empty `loader` no model can be loaded.
  explicit LoadedModels(ModelLoader loader) : loader_(std::move(loader)) {}

  [[nodiscard]] bool has_loader() const { return loader_ != nullptr; }

  /// Errors: kFailedPrecondition without a loader; those of the loader.
  Result<const LoadedModel*> load(const std::filesystem::path& store, const ModelInfo& info);

 private:
  ModelLoader loader_;
  std::map<std::string, LoadedModel> models_;  ///< The key is the model's file.
};

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
