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

/// The models of one store, each opened when it is needed for the first time. They stay open: who
/// predicts by one need not fear for it.
///
/// Threading: one thread.
class LoadedModels {
 public:
  /// May be empty: then no model can be loaded.
  explicit LoadedModels(ModelLoader loader) : loader_(std::move(loader)) {}

  [[nodiscard]] bool has_loader() const { return loader_ != nullptr; }

  /// Errors: kFailedPrecondition without a loader; those of the loader.
  Result<const LoadedModel*> load(const std::filesystem::path& store, const ModelInfo& info);

 private:
  ModelLoader loader_;
  std::map<std::string, LoadedModel> models_;  ///< By file.
};

/// Reads snapshots of one generation of a store from whatever form holds them.
///
/// Threading: one thread.
class PastReader {
 public:
  /// `models` of the same store, perhaps of an earlier generation of it.
  PastReader(std::unique_ptr<StoreReader> store, std::shared_ptr<LoadedModels> models)
      : store_(std::move(store)), models_(std::move(models)) {}

  [[nodiscard]] StoreReader& store() { return *store_; }

  /// A model of the store's manifest. Errors: those of LoadedModels::load.
  Result<const LoadedModel*> load(const ModelInfo& info) {
    return models_->load(store_->path(), info);
  }

  /// Errors: kDataLoss; those of load().
  Result<SnapshotResult> read(const MemoryId& entity, const SnapshotEntry& entry, Prefer prefer);

  /// The instances of a snapshot without their data, and the source that read() takes.
  Result<SnapshotResult> name(const MemoryId& entity, const SnapshotEntry& entry, Prefer prefer);

 private:
  Result<const ModelInfo*> find_model(const MemoryId& entity, int version) const;
  Result<SnapshotResult> read_recorded(const MemoryId& entity, const SnapshotEntry& entry);
  Result<SnapshotResult> reconstruct(const MemoryId& entity, const SnapshotEntry& entry);

  std::unique_ptr<StoreReader> store_;
  std::shared_ptr<LoadedModels> models_;
};

}  // namespace engram::ltm
