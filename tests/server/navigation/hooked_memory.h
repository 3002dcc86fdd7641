// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "memory/memory.h"

namespace engram::navigation::testing {

/// A memory whose questions go through a hook, which may take its time or refuse them.
///
/// Owns: the memory that answers.
/// Threading: thread-safe, but the hook is set while nobody asks.
class HookedMemory final : public Memory {
 public:
  explicit HookedMemory(std::unique_ptr<Memory> inner) : inner_(std::move(inner)) {}

  /// Called before each question, by whoever asks. An error is the answer.
  std::function<Status()> on_query;
  /// Subscriptions tell of snapshots of more bytes without their data; 0: of none.
  size_t inline_bytes = 0;

  Status declare(const ltm::MemoryId& segment, const idf::Type& type) override {
    return inner_->declare(segment, type);
  }
  Status commit(const ltm::Commit& commit,
                CommitDurability durability = CommitDurability::kDefault) override {
    return inner_->commit(commit, durability);
  }
  using Memory::query;
  Result<ltm::QueryResult> query(const ltm::Query& query, const std::string& engine) override {
    if (on_query) {
      ENGRAM_RETURN_IF_ERROR(on_query());
    }
    return inner_->query(query, engine);
  }
  using Memory::engines;
  Result<std::vector<ltm::EngineRecord>> engines(const ltm::MemoryId& entity, Duration ahead,
                                                 std::optional<Time> at) override {
    return inner_->engines(entity, ahead, at);
  }
  Result<ltm::SimilarAnswer> similar(const ltm::SimilarRequest& request) override {
    return inner_->similar(request);
  }
  Result<std::unique_ptr<Subscription>> subscribe(const SubscriptionOptions& options,
                                                  SubscriptionHandlers handlers) override {
    SubscriptionOptions bounded = options;
    if (inline_bytes > 0) bounded.inline_bytes = inline_bytes;
    return inner_->subscribe(bounded, std::move(handlers));
  }
  Status close() override { return inner_->close(); }

 private:
  Result<std::vector<ltm::SnapshotResult>> predict_from(const ltm::MemoryId& entity,
                                                        std::span<const Duration> horizons,
                                                        const PredictOptions& options) override {
    return inner_->predict(entity, horizons, options);
  }

  const std::unique_ptr<Memory> inner_;
};

}  // namespace engram::navigation::testing
