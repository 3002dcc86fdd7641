// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>

#include "ltm/memory/result.h"
#include "ltm/recall/model.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// Which form answers where a snapshot has both.
enum class Prefer { kRecorded, kLatent };

/// Reads snapshots of a store from whatever form holds them, and keeps the models that it loads.
///
/// Threading: one thread.
class PastReader {
 public:
  /// Without a `loader` latents cannot be decoded.
  PastReader(std::unique_ptr<StoreReader> store, ModelLoader loader)
      : store_(std::move(store)), loader_(std::move(loader)) {}

  [[nodiscard]] StoreReader& store() { return *store_; }
  [[nodiscard]] bool has_loader() const { return loader_ != nullptr; }

  /// A model of the store's manifest. Lives as long as this.
  /// Errors: kFailedPrecondition without a loader; those of the loader.
  Result<const LoadedModel*> load(const ModelInfo& info);

  /// Errors: kDataLoss; those of load().
  Result<SnapshotResult> read(const MemoryId& entity, const SnapshotEntry& entry, Prefer prefer);

  /// The instances of a snapshot without their data, and the source that read() takes.
  Result<SnapshotResult> name(const MemoryId& entity, const SnapshotEntry& entry, Prefer prefer);

 private:
  Result<const ModelInfo*> find_model(const MemoryId& entity, int version) const;
  Result<SnapshotResult> read_recorded(const MemoryId& entity, const SnapshotEntry& entry);
  Result<SnapshotResult> reconstruct(const MemoryId& entity, const SnapshotEntry& entry);

  std::unique_ptr<StoreReader> store_;
  ModelLoader loader_;
  std::map<std::string, LoadedModel> models_;  ///< By file.
};

}  // namespace engram::ltm
