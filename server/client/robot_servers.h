// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/mutex.h"
#include "server/client/memory_client.h"
#include "server/client/names_client.h"

namespace engram::server {

/// The servers of a robot, as the name system last reported them, with a connection to each server
/// that is used.
///
/// Threading: thread-safe.
class RobotServers {
 public:
  /// The max age of the list of servers where servers that have just arrived matter.
  static constexpr Duration kFreshFor = std::chrono::milliseconds(300);
  /// How long a server that disappeared is waited for: a server that restarts is back by then.
  static constexpr Duration kGoneAfter = std::chrono::seconds(10);

  static Result<std::unique_ptr<RobotServers>> connect(const std::string& names,
                                                       const ClientOptions& options);

  /// Asks the name system for its servers, unless it was asked within `age`, successfully or not.
  /// Errors: those of NamesClient::resolve; the previous list then stays.
  Status renew(Duration age = Duration(0)) ENGRAM_EXCLUDES(renewing_, mutex_);

  /// Like renew(), for callers that can continue with the previous list. If the name system cannot
  /// be reached, that is logged once per outage, and absence() reports it for a missing memory.
  void refresh(Duration age);

  /// Why no server is known to have a memory: kUnavailable if the name system could not be reached
  /// last time or the server that had the memory is gone; otherwise kNotFound.
  [[nodiscard]] Status absence(std::string_view memory) const;

  /// All known servers, ordered by name.
  [[nodiscard]] std::vector<Registration> all() const;

  /// The server that has this memory, otherwise a server that takes any memory, otherwise nothing.
  [[nodiscard]] std::optional<Registration> holder(std::string_view memory) const;

  /// The servers that may have matching entities.
  [[nodiscard]] std::vector<Registration> holders(const ltm::Query& query) const;

  /// The last server known to have had a memory; empty if none ever had it.
  [[nodiscard]] std::string last_holder(std::string_view memory) const ENGRAM_EXCLUDES(mutex_);

  /// Memories in the query that had a server and have none now, mapped to that server. A memory
  /// that the query does not name literally is included only for kGoneAfter: a server that restarts
  /// is back by then.
  [[nodiscard]] std::map<std::string, std::string> gone(const ltm::Query& query) const;

  /// A connection to the server's nearest endpoint, shared by all callers.
  /// Errors: kUnavailable if the server has no endpoint that this host can use.
  Result<std::shared_ptr<MemoryClient>> client(const Registration& server);

  /// Like client(), but the caller owns the connection alone.
  Result<std::unique_ptr<MemoryClient>> own_client(const Registration& server,
                                                   const ClientOptions& options);

  /// Discards a connection that failed; the next one may go to another endpoint.
  void drop(const std::string& server, const MemoryClient* client);

  [[nodiscard]] const ClientOptions& options() const { return options_; }

 private:
  struct Connection {
    Mutex opening;  ///< Held while the connection is opened, so that it is opened once.
    std::shared_ptr<MemoryClient> client ENGRAM_GUARDED_BY(opening);
    /// The server's endpoints when this one was chosen.
    std::vector<std::string> endpoints ENGRAM_GUARDED_BY(opening);
  };

  explicit RobotServers(const ClientOptions& options) : options_(options) {}

  Result<std::string> nearest(const Registration& server) ENGRAM_EXCLUDES(mutex_);
  [[nodiscard]] bool answers(const std::string& endpoint, const std::string& server) const;
  std::shared_ptr<Connection> connection(const std::string& server) ENGRAM_EXCLUDES(mutex_);

  ClientOptions options_;
  std::unique_ptr<NamesClient> names_;

  /// Held while the name system is asked.
  mutable Mutex renewing_ ENGRAM_ACQUIRED_BEFORE(mutex_);
  SteadyTime renewed_ ENGRAM_GUARDED_BY(renewing_){};
  Status renewal_ ENGRAM_GUARDED_BY(renewing_);

  mutable Mutex mutex_;
  std::vector<Registration> servers_ ENGRAM_GUARDED_BY(mutex_);
  struct LastHolder {
    std::string server;
    SteadyTime seen;
  };
  /// Keyed by memory.
  std::map<std::string, LastHolder, std::less<>> last_holders_ ENGRAM_GUARDED_BY(mutex_);
  std::map<std::string, std::shared_ptr<Connection>> connections_ ENGRAM_GUARDED_BY(mutex_);
  /// Keyed by server: counts the tries of endpoints on other hosts, so that each try takes the
  /// next.
  std::map<std::string, size_t> tries_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::server
