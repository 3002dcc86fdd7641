// SPDX-License-Identifier: Apache-2.0
#include "server/client/robot_subscription.h"

#include <set>
#include <thread>

#include "ltm/core/mutex.h"

namespace engram::server {

namespace {

/// The interval at which the client looks for new servers.
constexpr auto kLookEvery = std::chrono::milliseconds(300);
/// How long a server may take to confirm a subscription; the other servers wait meanwhile.
constexpr Duration kStartTimeout = std::chrono::seconds(2);
Result<ltm::Query> entities_of(const std::vector<std::string>& names) {
  return names.empty() ? ltm::Query()
                       : ltm::Query::parse(fmt::format("{}", fmt::join(names, " ; ")));
}

class RobotSubscription final : public Subscription {
 public:
  RobotSubscription(RobotServers& servers, std::shared_ptr<void> owner, SubscriptionOptions options,
                    ltm::Query entities, SubscriptionHandlers handlers)
      : owner_(std::move(owner)),
        servers_(servers),
        options_(std::move(options)),
        entities_(std::move(entities)),
        handlers_(std::move(handlers)) {}

  ~RobotSubscription() override {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
    feeds_.clear();
  }

  Status begin() {
    ENGRAM_RETURN_IF_ERROR(look());
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    return {};
  }

 private:
  /// The subscription at one server.
  struct Feed {
    std::vector<std::string> endpoints;  ///< The server's endpoints when the client subscribed.
    std::unique_ptr<MemoryClient> client;
    std::unique_ptr<Subscription> subscription;
    std::optional<SteadyTime> gone_since;  ///< When it disappeared from the name system.
  };

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      {
        const MutexLock lock(waiting_);
        wake_.wait_for(waiting_, stop, kLookEvery, [] { return false; });
      }
      if (stop.stop_requested()) return;
      // The server accepted this subscription before, so a refusal is reported and tried again.
      if (const Status status = look(); !status.ok()) interrupted(status);
    }
  }

  /// Subscribes to servers that are new or have moved.
  Status look() {
    const bool is_told = servers_.renew(std::chrono::milliseconds(100)).ok();
    const auto holders = servers_.holders(entities_);
    if (is_told) forget_gone(holders);
    std::vector<std::pair<Registration, Feed>> opened;
    for (const Registration& server : holders) {
      const auto known = feeds_.find(server.server);
      if (known != feeds_.end() && known->second.endpoints == server.endpoints) continue;
      opened.emplace_back(server, Feed());
    }
    std::vector<Status> statuses(opened.size());
    {
      std::vector<std::jthread> threads;
      for (size_t i = 0; i < opened.size(); ++i)
        threads.emplace_back([&, i] { statuses[i] = open(opened[i].first, opened[i].second); });
    }
    Status refused;
    for (size_t i = 0; i < opened.size(); ++i) {
      auto& [server, feed] = opened[i];
      if (statuses[i].ok()) {
        unreachable_.erase(server.server);
        feeds_.insert_or_assign(server.server, std::move(feed));
        continue;
      }
      const Status status = statuses[i].with_context(fmt::format("server '{}'", server.server));
      const bool is_lost =
          status.code() == StatusCode::kUnavailable || status.code() == StatusCode::kCancelled;
      // An unreachable server is reported once, not at each look.
      if (!is_lost)
        refused = status;
      else if (unreachable_.insert(server.server).second)
        interrupted(status);
    }
    return refused;
  }

  Status open(const Registration& server, Feed& feed) {
    ClientOptions options = servers_.options();
    options.timeout = std::min(options.timeout, kStartTimeout);
    ENGRAM_ASSIGN_OR_RETURN(feed.client, servers_.own_client(server, options));
    feed.endpoints = server.endpoints;
    SubscriptionHandlers handlers;
    handlers.on_snapshots = [this](std::vector<ToldSnapshot> told) {
      const MutexLock one_at_a_time(telling_);
      if (handlers_.on_snapshots) handlers_.on_snapshots(std::move(told));
    };
    handlers.on_lost = [this](uint64_t lost) {
      const MutexLock one_at_a_time(telling_);
      if (handlers_.on_lost) handlers_.on_lost(lost);
    };
    handlers.on_interrupted = [this, name = server.server](const Status& status) {
      interrupted(status.with_context(fmt::format("server '{}'", name)));
    };
    ENGRAM_ASSIGN_OR_RETURN(feed.subscription,
                            feed.client->subscribe(options_, std::move(handlers)));
    return {};
  }

  void interrupted(const Status& status) {
    const MutexLock one_at_a_time(telling_);
    if (handlers_.on_interrupted) handlers_.on_interrupted(status);
  }

  void forget_gone(const std::vector<Registration>& holders) {
    std::set<std::string> there;
    for (const Registration& server : holders) there.insert(server.server);
    for (auto feed = feeds_.begin(); feed != feeds_.end();) {
      auto& since = feed->second.gone_since;
      if (there.contains(feed->first))
        since.reset();
      else if (!since)
        since = steady_now();
      const bool is_gone = since && steady_now() - *since > RobotServers::kGoneAfter;
      feed = is_gone ? feeds_.erase(feed) : std::next(feed);
    }
  }

  const std::shared_ptr<void> owner_;
  RobotServers& servers_;
  const SubscriptionOptions options_;
  const ltm::Query entities_;
  const SubscriptionHandlers handlers_;
  Mutex telling_;  ///< Held while a handler runs: they are called one at a time.

  // Used by one thread at a time: first by begin(), then by `thread_`.
  std::map<std::string, Feed> feeds_;
  std::set<std::string> unreachable_;

  Mutex waiting_;  ///< `wake_` needs a mutex; this one guards no member.
  StoppableCondition wake_;
  std::jthread thread_;
};

}  // namespace

Result<std::unique_ptr<Subscription>> subscribe_to_robot(RobotServers& servers,
                                                         std::shared_ptr<void> owner,
                                                         const SubscriptionOptions& options,
                                                         SubscriptionHandlers handlers) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::Query entities, entities_of(options.names));
  auto subscription = std::make_unique<RobotSubscription>(servers, std::move(owner), options,
                                                          std::move(entities), std::move(handlers));
  ENGRAM_RETURN_IF_ERROR(subscription->begin());
  return std::unique_ptr<Subscription>(std::move(subscription));
}

}  // namespace engram::server
