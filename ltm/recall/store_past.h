// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>

#include "ltm/recall/decoded_cache.h"
#include "ltm/recall/known_past.h"
#include "ltm/recall/past_reader.h"
#include "ltm/store/store_mark.h"

namespace engram::ltm {

/// The past that a store has: one generation of it, until it is renewed.
///
/// Threading: one thread; `counters` from any.
class StorePast final : public KnownPast {
 public:
  struct Options {
    /// Decoded snapshots that are kept for the next who asks. Unit: plain bytes. A server sets it;
    /// a program that reads each snapshot once gains nothing by it.
    size_t max_decoded_bytes = 0;
    /// Each question is about the store as it is then. Else about that of the opening: who reads
    /// much of it wants one generation.
    bool follows_changes = false;
  };

  struct Counters {
    uint64_t opened = 0;         ///< Times that the store was opened.
    uint64_t decoded = 0;        ///< Snapshots.
    uint64_t from_decoded = 0;   ///< That had been decoded before.
    uint64_t decoded_bytes = 0;  ///< That are kept.
  };

  /// Without a `loader` latents cannot be decoded and no model predicts.
  StorePast(std::unique_ptr<StoreReader> store, ModelLoader loader, const Options& options);
  StorePast(std::unique_ptr<StoreReader> store, ModelLoader loader)
      : StorePast(std::move(store), std::move(loader), Options{}) {}

  /// Errors: those of StoreReader::open.
  static Result<std::unique_ptr<StorePast>> open(const std::filesystem::path& store,
                                                 ModelLoader loader, const Options& options);

  /// As it is until renew().
  [[nodiscard]] StoreReader& store() { return reader_->store(); }

  [[nodiscard]] std::string name() const override;
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query) override;
  Result<std::unique_ptr<EntityPast>> of(const MemoryId& entity) override;
  [[nodiscard]] std::optional<idf::Type> type_of(const MemoryId& entity) const override;
  Result<std::vector<Engine>> models(const MemoryId& entity) override;
  /// Models stay loaded. Errors: those of StoreReader::open; then all stays as it was.
  Status renew() override;
  Status follow() override;

  /// Something was published since it was opened.
  [[nodiscard]] bool is_outdated() const;

  /// What was decoded of this snapshot is not used again: it has been recorded anew.
  void forget_decoded(const MemoryId& snapshot);
  /// The same of all.
  void forget_decoded();

  [[nodiscard]] Counters counters() const;

 private:
  class Entity;

  const Options options_;
  StoreMark mark_;  ///< Of before it was opened; empty where that is not known.
  std::shared_ptr<LoadedModels> models_;
  std::shared_ptr<PastReader> reader_;  ///< Shared with the entities' pasts of its generation.
  DecodedCache decoded_;
  std::atomic<uint64_t> opened_{1};
  std::atomic<uint64_t> decodings_{0};
  std::atomic<uint64_t> from_decoded_{0};
  std::atomic<uint64_t> decoded_bytes_{0};
};

}  // namespace engram::ltm
