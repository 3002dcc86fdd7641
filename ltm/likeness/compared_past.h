// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/recall/store_past.h"
#include "ltm/working/working_memory.h"

namespace engram::ltm {

/// The past whose moments are compared: a store, and what a working memory above it holds. A moment
/// that both have is that of working memory.
///
/// Threading: one thread; the working memory may be used at the same time.
class ComparedPast final : public KnownPast {
 public:
  /// Both must outlive it. With a null `memory` it is the store alone.
  explicit ComparedPast(StorePast& store, const WorkingMemory* memory = nullptr)
      : store_(store), memory_(memory) {}

  [[nodiscard]] StoreReader& store() { return store_.store(); }

  /// What working memory holds of an entity, in the order of time, as it was at the first call for
  /// it. Call it before the store is renewed: what leaves working memory later is in the store by
  /// then.
  const std::vector<SharedSnapshot>& held(const MemoryId& entity);

  /// The past of an entity in the store alone; null if it has none there.
  Result<std::unique_ptr<EntityPast>> stored(const MemoryId& entity) { return store_.of(entity); }

  [[nodiscard]] std::string name() const override { return store_.name(); }
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query) override;
  Result<std::unique_ptr<EntityPast>> of(const MemoryId& entity) override;
  [[nodiscard]] std::optional<idf::Type> type_of(const MemoryId& entity) const override {
    // Working memory knows a type before the store does, which learns it with the next seal.
    if (memory_ != nullptr)
      if (auto type = memory_->type_of(entity)) return type;
    return store_.type_of(entity);
  }
  Result<std::vector<Engine>> models(const MemoryId& entity) override {
    return store_.models(entity);
  }
  void keep_decoded(bool keeps) override { store_.keep_decoded(keeps); }
  Status renew() override { return store_.renew(); }
  Status start_anew() override { return store_.start_anew(); }
  Status follow() override { return store_.follow(); }

 private:
  StorePast& store_;
  const WorkingMemory* const memory_;
  std::map<MemoryId, std::vector<SharedSnapshot>> held_;
};

}  // namespace engram::ltm
