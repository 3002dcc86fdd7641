// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/recall/known_past.h"
#include "ltm/recall/recorded_entities.h"
#include "ltm/recall/store_past.h"
#include "ltm/working/working_memory.h"

namespace engram::ltm {

/// Joins the past in a working memory and in the store below it. A moment that both have is
/// answered from working memory.
///
/// The store is read only if the held snapshots cannot give the answer. It is opened again if
/// snapshots were recorded to it since it was opened.
/// Threading: one thread; the working memory and the recording may run at the same time.
class JoinedPast final : public KnownPast {
 public:
  /// `memory` and `recorded` must outlive it; `recorded` is told which entities the store has. With
  /// a null `store` only working memory answers.
  static std::unique_ptr<JoinedPast> create(std::string name, const WorkingMemory& memory,
                                            std::unique_ptr<StorePast> store,
                                            RecordedEntities& recorded);

  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query) override;
  Result<std::unique_ptr<EntityPast>> of(const MemoryId& entity) override;
  [[nodiscard]] std::optional<idf::Type> type_of(const MemoryId& entity) const override;
  Result<std::vector<Engine>> models(const MemoryId& entity) override;
  void keep_decoded(bool keeps) override {
    if (store_) store_->keep_decoded(keeps);
  }
  Status renew() override;
  Status start_anew() override;
  /// Follows what a consolidation publishes, above all models. Recordings are followed without it.
  Status follow() override;

  /// Null without a store.
  [[nodiscard]] const StorePast* store() const { return store_.get(); }

 private:
  JoinedPast(std::string name, const WorkingMemory& memory, std::unique_ptr<StorePast> store,
             RecordedEntities& recorded)
      : name_(std::move(name)), memory_(memory), store_(std::move(store)), recorded_(recorded) {}

  /// The past of an entity in the newest state of the store; null if the store has none.
  Result<std::unique_ptr<EntityPast>> stored(const MemoryId& entity);
  template <typename Renew>
  Status renew_by(const Renew& renew);

  const std::string name_;
  const WorkingMemory& memory_;
  const std::unique_ptr<StorePast> store_;
  RecordedEntities& recorded_;
  uint64_t seen_ = 0;  ///< Number of the last recording that the opened store shows.
};

/// What the past of an entity is joined of.
struct JoinedParts {
  SharedSnapshot newest{};  ///< That working memory holds. Null: it holds none.
  /// All that it holds, sorted by time. Called once at most, and only if one beside the newest is
  /// asked for, or the store is.
  std::function<std::vector<SharedSnapshot>()> held;
  /// The store has no moment after this, and none at all if it is empty. Called at once, and again
  /// after `held`.
  std::function<std::optional<Time>()> until;
  /// The past in the store, or null. Called once at most successfully, after `held`: what leaves
  /// working memory is in the store before it is gone from there.
  std::function<Result<std::unique_ptr<EntityPast>>()> stored;
};

/// Joins the held and the stored moments of an entity, as they are now: nothing after the newest
/// held moment and the first answer of `until` is part of it, whatever the store has when it is
/// opened.
[[nodiscard]] std::unique_ptr<EntityPast> join_pasts(JoinedParts parts);

}  // namespace engram::ltm
