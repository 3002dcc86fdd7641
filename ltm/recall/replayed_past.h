// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/recall/entity_arrivals.h"
#include "ltm/recall/store_past.h"

namespace engram::ltm {

/// Arrivals that were read of one generation of a store, for all that read it.
///
/// Threading: thread-safe.
class KnownArrivals {
 public:
  /// Null if those of this entity were not read yet.
  [[nodiscard]] std::shared_ptr<const EntityArrivals> find(const MemoryId& entity) const;
  void put(const MemoryId& entity, std::shared_ptr<const EntityArrivals> arrivals);

 private:
  mutable SharedMutex mutex_;
  std::map<MemoryId, std::shared_ptr<const EntityArrivals>> arrivals_ ENGRAM_GUARDED_BY(mutex_);
};

/// The past in a store as it was known at a moment of it: nothing that arrived later can be found,
/// counted, named or learned from. That moment is read anew from a clock before each question
/// (follow()), so one answer is of one moment.
///
/// A model answers only if all that it was trained on lies before that moment. Of several the
/// newest such model predicts; one that does not tell what it was trained on never does. Decoding
/// latents is no prediction: it gives back the snapshot of its own time by whichever model coded
/// it.
/// Threading: one thread; the clock may be set by others.
/// Source: docs/replay.md.
class ReplayedPast final : public KnownPast {
 public:
  /// `now` is called by follow(). Pasts of one generation of a store may share what they read.
  ReplayedPast(std::unique_ptr<StorePast> store, Clock now,
               std::shared_ptr<KnownArrivals> arrivals = std::make_shared<KnownArrivals>());

  /// Opens the newest generation. It shares what is read with `beside` if that is of the same.
  /// Errors: those of StorePast::open.
  static Result<std::unique_ptr<ReplayedPast>> open(const std::filesystem::path& store,
                                                    ModelLoader loader, Clock now,
                                                    ReplayedPast* beside = nullptr);

  /// The store, of which more can be read than was known. Valid until renew().
  [[nodiscard]] StoreReader& store() { return store_->store(); }

  /// When the snapshots of an entity arrived. Needs an entity of the store.
  /// Errors: those of EntityArrivals::read.
  Result<std::shared_ptr<const EntityArrivals>> arrivals(const MemoryId& entity);

  [[nodiscard]] std::string name() const override { return store_->name(); }
  /// Entities of which nothing can be read yet because of damage count as known.
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query) override;
  Result<std::unique_ptr<EntityPast>> of(const MemoryId& entity) override;
  [[nodiscard]] std::optional<idf::Type> type_of(const MemoryId& entity) const override {
    return store_->type_of(entity);
  }
  Result<std::vector<Engine>> models(const MemoryId& entity) override {
    return store_->models_trained_until(entity, now_);
  }
  void keep_decoded(bool keeps) override { store_->keep_decoded(keeps); }
  Status renew() override;
  Status start_anew() override;
  Status follow() override;
  [[nodiscard]] uint64_t era() const override { return era_; }

 private:
  const std::unique_ptr<StorePast> store_;
  const Clock clock_;
  Time now_;
  uint64_t era_ = 0;  ///< How often that moment became an earlier one.
  std::shared_ptr<KnownArrivals> arrivals_;
};

}  // namespace engram::ltm
