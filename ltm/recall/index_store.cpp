// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/index_store.h"

#include "ltm/recall/past_reader.h"

namespace engram::ltm {

Result<ContextIndexing> index_store(const std::filesystem::path& store, const ModelLoader& loader,
                                    const std::function<bool()>& is_over,
                                    const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(auto opened, StoreReader::open(store));
  PastReader reader(std::move(opened), std::make_shared<LoadedModels>(loader));
  return index_contexts(
      reader.store(),
      [&reader](const MemoryId& entity, const SnapshotEntry& entry) {
        return reader.read(entity, entry, Prefer::kLatent);
      },
      is_over, progress, stop);
}

}  // namespace engram::ltm
