// SPDX-License-Identifier: Apache-2.0
// Memories that this program opens itself, see Memory::open.
#include <atomic>

#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "ltm/likeness/store_likeness.h"
#include "ltm/recording/recording_config.h"
#include "ltm/saliency/why_salient.h"
#include "memory/live/local_subscription.h"
#include "memory/live/memory_service.h"
#include "memory/memory.h"
#include "memory/model_loader.h"
#include "memory/replay/running_replay.h"

namespace engram {

namespace {

ltm::PredictionRequest request_of(std::span<const Duration> horizons,
                                  const PredictOptions& options) {
  return {options.at, {horizons.begin(), horizons.end()}, options.engine, options.plan};
}

/// Values take several times their bytes in RAM.
constexpr size_t kPartBytes = size_t{256} << 10;

/// Visits the parts of an answer, see Memory::query_parts.
template <typename Begin, typename Next>
Status visit_parts(const Begin& begin, const Next& next, const Memory::PartVisit& visit) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::Recall::AnswerCursor cursor, begin());
  while (!cursor.is_done()) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Answer part, next(cursor));
    ENGRAM_RETURN_IF_ERROR(visit(std::move(part).to_result()));
  }
  return {};
}

/// A store that is read beside its writer. Each answer shows the store as it is at that moment.
class ReadMemory final : public Memory {
 public:
  ReadMemory(std::unique_ptr<ltm::StorePast> past, std::unique_ptr<ltm::AccessLog> accesses,
             const ltm::Recall::Options& options)
      : name_(past->name()),
        path_(past->store().path()),
        likeness_(past->store().path(), model_loader()),
        recall_(std::in_place, std::move(past), std::move(accesses)),
        options_(options) {}

  Status declare(const ltm::MemoryId& /*segment*/, const idf::Type& /*type*/) override {
    return is_read_only();
  }
  Status commit(const ltm::Commit& /*commit*/, CommitDurability /*durability*/) override {
    return is_read_only();
  }
  Result<std::unique_ptr<Subscription>> subscribe(const SubscriptionOptions& /*options*/,
                                                  SubscriptionHandlers /*handlers*/) override {
    return is_read_only();
  }

  using Memory::query;
  Result<ltm::QueryResult> query(const ltm::Query& query, const std::string& engine) override {
    // Recall caches decoded snapshots and is not thread-safe, so queries take turns.
    const MutexLock lock(mutex_);
    if (!recall_) return is_closed();
    ltm::Recall::Options options = options_;
    options.engine = engine;
    return recall_->query(query, options);
  }

  Status query_parts(const ltm::Query& query, const PartVisit& visit,
                     const std::string& engine) override {
    ltm::Recall::Options options = options_;
    options.engine = engine;
    return visit_parts(
        [&] {
          return with_recall([&](ltm::Recall& recall) { return recall.begin(query, options); });
        },
        [&](ltm::Recall::AnswerCursor& cursor) {
          return with_recall([&](ltm::Recall& recall) { return recall.next(cursor, kPartBytes); });
        },
        visit);
  }

  Result<std::vector<ltm::EngineRecord>> engines(const ltm::MemoryId& entity, Duration ahead,
                                                 std::optional<Time> at) override {
    const MutexLock lock(mutex_);
    if (!recall_) return is_closed();
    return recall_->records(entity, at, ahead, options_);
  }

  Result<ltm::SimilarAnswer> similar(const ltm::SimilarRequest& request) override {
    {
      const MutexLock lock(mutex_);
      if (!recall_) return is_closed();
    }
    return likeness_.similar(request);
  }

  Result<ltm::MomentMap> map(const ltm::MemoryId& entity, size_t max_moments) override {
    {
      const MutexLock lock(mutex_);
      if (!recall_) return is_closed();
    }
    return likeness_.map(entity, max_moments);
  }

  using Memory::why_salient;
  Result<ltm::SalientMoment> why_salient(const ltm::MemoryId& entity,
                                         std::optional<Time> time) override {
    {
      const MutexLock lock(mutex_);
      if (!recall_) return is_closed();
    }
    return ltm::why_salient(path_, model_loader(), entity, time);
  }

  Status close() override {
    const MutexLock lock(mutex_);
    recall_.reset();
    return {};
  }

 private:
  Result<std::vector<ltm::SnapshotResult>> predict_from(const ltm::MemoryId& entity,
                                                        std::span<const Duration> horizons,
                                                        const PredictOptions& options) override {
    const MutexLock lock(mutex_);
    if (!recall_) return is_closed();
    return recall_->predict(entity, request_of(horizons, options), options_);
  }

  /// Asks the recall, if it is open. Others take their turn between calls.
  template <typename Ask>
  auto with_recall(const Ask& ask) -> decltype(ask(std::declval<ltm::Recall&>())) {
    const MutexLock lock(mutex_);
    if (!recall_) return is_closed();
    return ask(*recall_);
  }

  [[nodiscard]] Status is_read_only() const {
    return failed_precondition("{}: is opened for reading alone", name_);
  }
  [[nodiscard]] Status is_closed() const { return failed_precondition("{}: is closed", name_); }

  const std::string name_;
  const std::filesystem::path path_;
  ltm::StoreLikeness likeness_;
  Mutex mutex_;
  std::optional<ltm::Recall> recall_ ENGRAM_GUARDED_BY(mutex_);
  const ltm::Recall::Options options_;
};

/// A store with a working memory above it, in this process: one that is written to, or a replay.
class LiveMemory final : public Memory {
 public:
  explicit LiveMemory(std::unique_ptr<memory::MemoryService> service)
      : service_(std::move(service)) {
    service_->tell_of_below(
        {.is_wanted =
             [hub = hub_](const ltm::MemoryId& entity) {
               return hub->listeners(entity) != nullptr;
             },
         .publish =
             [hub = hub_](std::span<const ltm::SharedSnapshot> told) { publish(*hub, told); }});
  }

  Status declare(const ltm::MemoryId& segment, const idf::Type& type) override {
    ENGRAM_RETURN_IF_ERROR(check_open());
    return service_->declare(segment, type);
  }

  Status commit(const ltm::Commit& commit, CommitDurability durability) override {
    ENGRAM_RETURN_IF_ERROR(check_open());
    const bool is_journal = durability != CommitDurability::kMemory;
    using Durability = memory::MemoryService::Durability;
    ENGRAM_ASSIGN_OR_RETURN(
        const ltm::Admission admission,
        service_->commit(commit, {}, is_journal ? Durability::kJournal : Durability::kMemory));
    // Subscribers are told before the commit is durable: they need not wait for the disk.
    publish(*hub_, admission.snapshots);
    return is_journal ? service_->wait_stored(admission) : Status();
  }

  using Memory::query;
  Result<ltm::QueryResult> query(const ltm::Query& query, const std::string& engine) override {
    ENGRAM_RETURN_IF_ERROR(check_open());
    ENGRAM_ASSIGN_OR_RETURN(ltm::Answer answer, service_->query(query, engine));
    return std::move(answer).to_result();
  }

  Status query_parts(const ltm::Query& query, const PartVisit& visit,
                     const std::string& engine) override {
    ENGRAM_RETURN_IF_ERROR(check_open());
    return visit_parts([&] { return service_->begin_query(query, engine); },
                       [&](auto& cursor) { return service_->next_part(cursor, kPartBytes); },
                       visit);
  }

  Result<std::vector<ltm::EngineRecord>> engines(const ltm::MemoryId& entity, Duration ahead,
                                                 std::optional<Time> at) override {
    ENGRAM_RETURN_IF_ERROR(check_open());
    return service_->engines(entity, ahead, at);
  }

  Result<ltm::SimilarAnswer> similar(const ltm::SimilarRequest& request) override {
    ENGRAM_RETURN_IF_ERROR(check_open());
    return service_->similar(request);
  }

  Result<ltm::MomentMap> map(const ltm::MemoryId& entity, size_t max_moments) override {
    ENGRAM_RETURN_IF_ERROR(check_open());
    return service_->map(entity, max_moments);
  }

  using Memory::why_salient;
  Result<ltm::SalientMoment> why_salient(const ltm::MemoryId& entity,
                                         std::optional<Time> time) override {
    ENGRAM_RETURN_IF_ERROR(check_open());
    if (!service_->options().store)
      return failed_precondition(
          "memory '{}': a replay does not explain saliency; open its store instead",
          service_->options().name);
    return ltm::why_salient(service_->options().store->store, model_loader(), entity, time);
  }

  Result<std::unique_ptr<Subscription>> subscribe(const SubscriptionOptions& options,
                                                  SubscriptionHandlers handlers) override {
    ENGRAM_RETURN_IF_ERROR(check_open());
    return memory::subscribe_locally(hub_, options, std::move(handlers));
  }

  Status close() override {
    is_closed_ = true;
    return service_->close();
  }

 private:
  Result<std::vector<ltm::SnapshotResult>> predict_from(const ltm::MemoryId& entity,
                                                        std::span<const Duration> horizons,
                                                        const PredictOptions& options) override {
    ENGRAM_RETURN_IF_ERROR(check_open());
    return service_->predict(entity, request_of(horizons, options));
  }

  static void publish(memory::EventHub& hub, std::span<const ltm::SharedSnapshot> told) {
    hub.publish(told, [](const ltm::SharedSnapshot& snapshot) {
      return std::make_shared<memory::CommitEvent>(snapshot);
    });
  }

  [[nodiscard]] Status check_open() const {
    if (!is_closed_) return {};
    return failed_precondition("memory '{}': is closed", service_->options().name);
  }

  const std::unique_ptr<memory::MemoryService> service_;
  const std::shared_ptr<memory::EventHub> hub_ = std::make_shared<memory::EventHub>();
  std::atomic<bool> is_closed_{false};
};

std::string name_of(const std::filesystem::path& store) {
  return store.filename().string().empty() ? store.string() : store.filename().string();
}

Result<std::unique_ptr<Memory>> open_to_read(const std::filesystem::path& store,
                                             const OpenOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(auto past,
                          ltm::StorePast::open(store, model_loader(), {.follows_changes = true}));
  ltm::Recall::Options recalling;
  recalling.prefer = options.prefers_latents ? ltm::Prefer::kLatent : ltm::Prefer::kRecorded;
  recalling.max_horizon = options.max_horizon;
  auto accesses = options.notes_reads
                      ? std::make_unique<ltm::AccessLog>(store, ltm::AccessLog::Options{})
                      : nullptr;
  return std::unique_ptr<Memory>(
      std::make_unique<ReadMemory>(std::move(past), std::move(accesses), recalling));
}

}  // namespace

Result<std::unique_ptr<Memory>> Memory::open(const std::filesystem::path& store,
                                             const OpenOptions& options) {
  if (options.is_read_only) return open_to_read(store, options);
  memory::MemoryService::Options service;
  service.name = name_of(store);
  service.memory.all.bytes = options.max_working_bytes;
  service.max_horizon = options.max_horizon;
  memory::LongTerm::Options& kept = service.store.emplace();
  kept.store = store;
  kept.prefers_latents = options.prefers_latents;
  if (!options.recording_config.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(kept.recording, ltm::read_recording_config(options.recording_config));
  }
  ENGRAM_ASSIGN_OR_RETURN(auto opened, memory::MemoryService::open(service, model_loader()));
  return std::unique_ptr<Memory>(std::make_unique<LiveMemory>(std::move(opened)));
}

Result<std::unique_ptr<Memory>> Memory::replay(const std::filesystem::path& store,
                                               const ReplayOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const auto replay,
                          memory::Replay::open({store}, model_loader(), options));
  memory::MemoryService::Options service;
  service.name = name_of(store);
  service.memory.mode = ltm::StoreMode::kLatest;
  service.below = replay->below(0);
  ENGRAM_ASSIGN_OR_RETURN(auto opened, memory::MemoryService::open(service, nullptr));
  return std::unique_ptr<Memory>(std::make_unique<LiveMemory>(std::move(opened)));
}

}  // namespace engram
