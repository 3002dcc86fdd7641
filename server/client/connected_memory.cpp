// SPDX-License-Identifier: Apache-2.0
// Memory::connect: memories of servers, behind the same interface as memories that a program opens
// itself.

#include "ltm/core/mutex.h"
#include "memory/memory.h"
#include "server/access/default_endpoint.h"
#include "server/client/memory_client.h"
#include "server/client/robot_memory.h"

namespace engram {

namespace {

/// A memory over one server (MemoryClient) or over all servers of a name system (RobotMemory).
template <typename Client>
class ConnectedMemory final : public Memory {
 public:
  ConnectedMemory(std::string endpoint, std::shared_ptr<Client> client)
      : endpoint_(std::move(endpoint)), client_(std::move(client)) {}

  Status declare(const ltm::MemoryId& segment, const idf::Type& type) override {
    const auto client = this->client();
    return client ? client->declare(segment, type) : is_closed();
  }

  Status commit(const ltm::Commit& commit, CommitDurability durability) override {
    const auto client = this->client();
    return client ? client->commit(commit, durability) : is_closed();
  }

  using Memory::query;
  Result<ltm::QueryResult> query(const ltm::Query& query, const std::string& engine) override {
    const auto client = this->client();
    if (!client) return is_closed();
    return client->query(query, engine);
  }

  Status query_parts(const ltm::Query& query, const PartVisit& visit,
                     const std::string& engine) override {
    const auto client = this->client();
    if (!client) return is_closed();
    return client->query_parts(query, visit, engine);
  }

  Result<std::vector<ltm::EngineRecord>> engines(const ltm::MemoryId& entity, Duration ahead,
                                                 std::optional<Time> at) override {
    const auto client = this->client();
    if (!client) return is_closed();
    ENGRAM_ASSIGN_OR_RETURN(auto records, client->engines(entity, {&ahead, 1}, at));
    if (records.size() != 1)
      return data_loss("server '{}': gave engines of {} horizons for one", endpoint_,
                       records.size());
    return std::move(records.front());
  }

  Result<ltm::SimilarAnswer> similar(const ltm::SimilarRequest& request) override {
    const auto client = this->client();
    if (!client) return is_closed();
    return client->similar(request);
  }

  Result<std::unique_ptr<Subscription>> subscribe(const SubscriptionOptions& options,
                                                  SubscriptionHandlers handlers) override {
    const auto client = this->client();
    if (!client) return is_closed();
    return client->subscribe(options, std::move(handlers));
  }

  Status close() override {
    const MutexLock lock(mutex_);
    client_.reset();
    return {};
  }

 private:
  Result<std::vector<ltm::SnapshotResult>> predict_from(const ltm::MemoryId& entity,
                                                        std::span<const Duration> horizons,
                                                        const PredictOptions& options) override {
    const auto client = this->client();
    if (!client) return is_closed();
    return client->predict(entity, horizons, options);
  }

  /// Returns a shared pointer, because a call may go on while another thread closes the memory.
  [[nodiscard]] std::shared_ptr<Client> client() {
    const MutexLock lock(mutex_);
    return client_;
  }

  [[nodiscard]] Status is_closed() const {
    return failed_precondition("server '{}': the connection is closed", endpoint_);
  }

  const std::string endpoint_;
  Mutex mutex_;
  std::shared_ptr<Client> client_ ENGRAM_GUARDED_BY(mutex_);
};

template <typename Client>
Result<std::unique_ptr<Memory>> connect_to(const std::string& endpoint,
                                           const server::ClientOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(auto client, Client::connect(endpoint, options));
  return std::unique_ptr<Memory>(
      std::make_unique<ConnectedMemory<Client>>(endpoint, std::move(client)));
}

}  // namespace

Result<std::unique_ptr<Memory>> Memory::connect(const std::string& endpoint,
                                                const ConnectOptions& options) {
  server::ClientOptions client;
  client.token = options.token;
  client.ca = options.ca;
  client.timeout = options.timeout;
  if (options.is_name_system) {
    if (endpoint.empty()) return invalid_argument("found no endpoint of a name system, needs one");
    return connect_to<server::RobotMemory>(endpoint, client);
  }
  if (!endpoint.empty()) return connect_to<server::MemoryClient>(endpoint, client);
  ENGRAM_ASSIGN_OR_RETURN(const server::Endpoint usual, server::default_endpoint());
  return connect_to<server::MemoryClient>(usual.to_string(), client);
}

}  // namespace engram
