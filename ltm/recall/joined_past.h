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

/// Joins the held moments of an entity, sorted by time, with the past that `stored` returns.
/// `stored` is called at most once successfully, when it is first needed, and may return null. The
/// store has no moment after `until`, and none at all if `until` is empty.
[[nodiscard]] std::unique_ptr<EntityPast> join_pasts(
    std::vector<SharedSnapshot> held, std::optional<Time> until,
    std::function<Result<std::unique_ptr<EntityPast>>()> stored);

}  // namespace engram::ltm
