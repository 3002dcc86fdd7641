// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ltm/recall/known_past.h"
#include "ltm/working/working_memory.h"

namespace engram::ltm {

/// A past that nobody adds to, under a working memory that is committed to and never stored. A
/// moment that both have is answered from working memory.
///
/// Threading: one thread; working memory may be committed to at the same time.
class OverlaidPast final : public KnownPast {
 public:
  /// `memory` must outlive it. `name` is that in messages.
  OverlaidPast(std::string name, const WorkingMemory& memory, std::unique_ptr<KnownPast> below)
      : name_(std::move(name)), memory_(memory), below_(std::move(below)) {}

  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query) override;
  Result<std::unique_ptr<EntityPast>> of(const MemoryId& entity) override;
  /// The types of working memory are those of both.
  [[nodiscard]] std::optional<idf::Type> type_of(const MemoryId& entity) const override {
    return memory_.type_of(entity);
  }
  Result<std::vector<Engine>> models(const MemoryId& entity) override {
    return below_->models(entity);
  }
  void keep_decoded(bool keeps) override { below_->keep_decoded(keeps); }
  Status renew() override { return below_->renew(); }
  Status start_anew() override { return below_->start_anew(); }
  Status follow() override { return below_->follow(); }
  [[nodiscard]] uint64_t era() const override { return below_->era(); }

 private:
  const std::string name_;
  const WorkingMemory& memory_;
  const std::unique_ptr<KnownPast> below_;
};

}  // namespace engram::ltm
