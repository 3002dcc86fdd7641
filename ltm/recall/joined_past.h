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

/// The past that a working memory and the store below it have together, as if they were one: a
/// moment that both have is answered from working memory.
///
/// The store is looked at only where what is held cannot tell, and opened anew where it has been
/// recorded to since.
/// Threading: one thread; the working memory and the recording go on beside it.
class JoinedPast final : public KnownPast {
 public:
  /// `memory` and `recorded`, which is told what the store has, outlive it; `store` may be null,
  /// then there is working memory alone.
  /// Errors: those of reading the store.
  static Result<std::unique_ptr<JoinedPast>> create(std::string name, const WorkingMemory& memory,
                                                    std::unique_ptr<StorePast> store,
                                                    RecordedEntities& recorded);

  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query) override;
  Result<std::unique_ptr<EntityPast>> of(const MemoryId& entity) override;
  [[nodiscard]] std::optional<idf::Type> type_of(const MemoryId& entity) const override;
  Result<std::vector<Engine>> models(const MemoryId& entity) override;
  Status renew() override;
  /// What a night publishes, models above all: recordings are told of by themselves.
  Status follow() override;

  /// Null without a store.
  [[nodiscard]] const StorePast* store() const { return store_.get(); }

 private:
  JoinedPast(std::string name, const WorkingMemory& memory, std::unique_ptr<StorePast> store,
             RecordedEntities& recorded)
      : name_(std::move(name)), memory_(memory), store_(std::move(store)), recorded_(recorded) {}

  /// What the store has of an entity, as it is now; null where it has nothing.
  Result<std::unique_ptr<EntityPast>> stored(const MemoryId& entity);

  const std::string name_;
  const WorkingMemory& memory_;
  const std::unique_ptr<StorePast> store_;
  RecordedEntities& recorded_;
  uint64_t seen_ = 0;  ///< Number of the last recording that the opened store shows.
};

/// The moments of an entity that are held, in the order of time, and those that `stored` gives when
/// it is asked for the first time, null where there are none. The store has none after `until`.
[[nodiscard]] std::unique_ptr<EntityPast> join_pasts(
    std::vector<SharedSnapshot> held, std::optional<Time> until,
    std::function<Result<std::unique_ptr<EntityPast>>()> stored);

}  // namespace engram::ltm
