// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>

#include "ltm/context/segment_contexts.h"
#include "ltm/recall/decoded_cache.h"
#include "ltm/recall/known_past.h"
#include "ltm/recall/past_reader.h"
#include "ltm/store/store_mark.h"

namespace engram::ltm {

/// The past in a store. It shows one generation of the store until it is renewed.
///
/// Threading: one thread; counters() from any thread.
class StorePast final : public KnownPast {
 public:
  struct Options {
    /// Max plain bytes of decoded snapshots in the cache. A server sets it; a program that reads
    /// each snapshot once gains nothing from it.
    size_t max_decoded_bytes = 0;
    /// If true, each question reads the newest state of the store. If false, all questions read the
    /// generation that was opened, as a program that reads much of a store wants.
    bool follows_changes = false;
  };

  struct Counters {
    uint64_t opened = 0;         ///< How often the store was opened.
    uint64_t decoded = 0;        ///< Snapshots that were decoded.
    uint64_t from_decoded = 0;   ///< Snapshots that came from the cache.
    uint64_t decoded_bytes = 0;  ///< Plain bytes in the cache.
    uint64_t damaged_models = 0;
    /// Snapshots that were answered as they were recorded, although latents were preferred.
    uint64_t substituted = 0;
  };

  /// Without a `loader` latents cannot be decoded and no model predicts.
  StorePast(std::unique_ptr<StoreReader> store, ModelLoader loader, const Options& options);
  StorePast(std::unique_ptr<StoreReader> store, ModelLoader loader)
      : StorePast(std::move(store), std::move(loader), Options{}) {}

  /// Errors: those of StoreReader::open.
  static Result<std::unique_ptr<StorePast>> open(const std::filesystem::path& store,
                                                 ModelLoader loader, const Options& options);

  /// Valid until renew().
  [[nodiscard]] StoreReader& store() { return reader_->store(); }

  [[nodiscard]] std::string name() const override;
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query) override;
  Result<std::unique_ptr<EntityPast>> of(const MemoryId& entity) override;
  [[nodiscard]] std::optional<idf::Type> type_of(const MemoryId& entity) const override;
  Result<std::vector<Engine>> models(const MemoryId& entity) override;
  /// Those of the newest model that was trained on nothing after `now`. Empty also if no model
  /// tells so.
  Result<std::vector<Engine>> models_trained_until(const MemoryId& entity, Time now);
  /// Models stay loaded.
  /// Errors: those of StoreReader::open; then nothing changes.
  void keep_decoded(bool keeps) override { keeps_decoded_ = keeps; }
  Status renew() override;
  Status start_anew() override;
  Status follow() override;

  /// True if something was published since the store was opened.
  [[nodiscard]] bool is_outdated() const;

  /// Removes a snapshot from the cache, because it was recorded again.
  void forget_decoded(const MemoryId& snapshot);
  /// Removes all snapshots from the cache.
  void forget_decoded();

  [[nodiscard]] Counters counters() const;

 private:
  class Entity;

  /// Max bytes of contexts that are kept for the next questions.
  static constexpr size_t kMaxContextCacheBytes = size_t{256} << 20;

  /// The context of an entity in a generation of the store; of the newest one it is kept.
  Result<SharedContext> context_of(const std::shared_ptr<PastReader>& reader,
                                   const MemoryId& entity);
  void clear_contexts();
  static std::vector<Engine> engines_of(const LoadedModel& model, const ModelInfo& info);

  const Options options_;
  StoreMark mark_;  ///< Taken before the store was opened; empty if that is not known.
  std::shared_ptr<LoadedModels> models_;
  std::shared_ptr<PastReader> reader_;  ///< Shared with the entity pasts of this generation.
  DecodedCache decoded_;
  bool keeps_decoded_ = true;
  std::unique_ptr<ContextIndexes> indexes_;     ///< Of this generation; null: none was read.
  std::map<MemoryId, SharedContext> contexts_;  ///< Of this generation.
  size_t context_bytes_ = 0;
  std::atomic<uint64_t> opened_{1};
  std::atomic<uint64_t> decodings_{0};
  std::atomic<uint64_t> from_decoded_{0};
  std::atomic<uint64_t> decoded_bytes_{0};
};

}  // namespace engram::ltm
