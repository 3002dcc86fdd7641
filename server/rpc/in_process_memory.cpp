// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/in_process_memory.h"

#include "memory/live/local_subscription.h"
#include "server/rpc/memory_rpc.h"

namespace engram::server {

namespace {

/// A subscription during which sensory memory passes what is subscribed to.
class AttendingSubscription final : public Subscription {
 public:
  AttendingSubscription(std::unique_ptr<Subscription> told, memory::Attention attention)
      : told_(std::move(told)), attention_(std::move(attention)) {}

 private:
  const std::unique_ptr<Subscription> told_;
  const memory::Attention attention_;
};

class InProcessMemory final : public Memory {
 public:
  explicit InProcessMemory(RpcContext& context)
      : context_(context),
        // The context owns the hub, and outlives this.
        hub_(&context.hub, [](memory::EventHub*) {}) {}

  Status declare(const ltm::MemoryId& segment, const idf::Type& type) override {
    return context_.service.declare(segment, type);
  }

  Status commit(const ltm::Commit& commit, CommitDurability durability) override {
    using Needed = memory::MemoryService::Durability;
    Needed needed = context_.durability;
    if (durability == CommitDurability::kMemory) needed = Needed::kMemory;
    if (durability == CommitDurability::kJournal) needed = Needed::kJournal;
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Admission admission,
                            context_.service.commit(commit, {}, needed));
    publish(context_, admission.snapshots);
    return needed == Needed::kJournal ? context_.service.wait_stored(admission) : Status();
  }

  using Memory::query;
  Result<ltm::QueryResult> query(const ltm::Query& query, const std::string& engine) override {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Answer answer, context_.service.query(query, engine));
    return std::move(answer).to_result();
  }

  Result<std::vector<ltm::EngineRecord>> engines(const ltm::MemoryId& entity, Duration ahead,
                                                 std::optional<Time> at) override {
    return context_.service.engines(entity, ahead, at);
  }

  Result<ltm::SimilarAnswer> similar(const ltm::SimilarRequest& request) override {
    return context_.service.similar(request);
  }

  Result<std::unique_ptr<Subscription>> subscribe(const SubscriptionOptions& options,
                                                  SubscriptionHandlers handlers) override {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Query names, subscribed_names(options.names));
    // What sensory memory holds passes now, and is the first that is told.
    memory::Attention attention;
    const auto attend = [&] {
      attention = context_.service.attend([names = std::move(names)](const ltm::MemoryId& entity) {
        return names.matches(entity);
      });
    };
    ENGRAM_ASSIGN_OR_RETURN(auto told,
                            memory::subscribe_locally(hub_, options, std::move(handlers), attend));
    return std::unique_ptr<Subscription>(
        std::make_unique<AttendingSubscription>(std::move(told), std::move(attention)));
  }

  Status close() override { return {}; }

 private:
  Result<std::vector<ltm::SnapshotResult>> predict_from(const ltm::MemoryId& entity,
                                                        std::span<const Duration> horizons,
                                                        const PredictOptions& options) override {
    return context_.service.predict(
        entity, {options.at, {horizons.begin(), horizons.end()}, options.engine, options.plan});
  }

  RpcContext& context_;
  const std::shared_ptr<memory::EventHub> hub_;
};

}  // namespace

std::unique_ptr<Memory> in_process_memory(RpcContext& context) {
  return std::make_unique<InProcessMemory>(context);
}

}  // namespace engram::server
