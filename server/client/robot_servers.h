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

/// The servers of a robot as the name system told them last, and a connection to each that is
/// used.
///
/// Threading: thread-safe.
class RobotServers {
 public:
  /// How old what is known may be where servers that just arrived matter.
  static constexpr Duration kFreshFor = std::chrono::milliseconds(300);
  static constexpr Duration kGoneAfter = std::chrono::seconds(10);

  static Result<std::unique_ptr<RobotServers>> connect(const std::string& names,
                                                       const ClientOptions& options);

  /// Asks the name system, unless that was done within `age`, with success or not.
  /// Errors: those of NamesClient::resolve; what was known stays.
  Status renew(Duration age = Duration(0)) ENGRAM_EXCLUDES(renewing_, mutex_);

  /// The same for who goes on with what was known: where the name system cannot be reached, that is
  /// logged once until it can be, and absence() tells it to who misses something.
  void refresh(Duration age);

  /// Why no server is known to have a memory: kUnavailable where the name system could not be asked
  /// last, or where the server that had it is gone; else kNotFound.
  [[nodiscard]] Status absence(std::string_view memory) const;

  /// All that are known, by their names.
  [[nodiscard]] std::vector<Registration> all() const;

  /// The server that has this memory, or takes any; nothing where none does.
  [[nodiscard]] std::optional<Registration> holder(std::string_view memory) const;

  /// Those that may have what is asked for.
  [[nodiscard]] std::vector<Registration> holders(const ltm::Query& query) const;

  /// The server that had a memory when it was last told; empty where none ever did.
  [[nodiscard]] std::string last_holder(std::string_view memory) const ENGRAM_EXCLUDES(mutex_);

  /// Memories that are asked for, had a server and have none now, with that server. Those that are
  /// not asked for by name only for kGoneAfter: a server that starts over is back by then.
  [[nodiscard]] std::map<std::string, std::string> gone(const ltm::Query& query) const;

  /// A connection to the server's nearest endpoint, shared with whoever asks.
  /// Errors: kUnavailable where it has no endpoint that this host can use.
  Result<std::shared_ptr<MemoryClient>> client(const Registration& server);

  /// The same, not shared.
  Result<std::unique_ptr<MemoryClient>> own_client(const Registration& server,
                                                   const ClientOptions& options);

  /// This connection did not do: the next one may be to another endpoint.
  void drop(const std::string& server, const MemoryClient* client);

  [[nodiscard]] const ClientOptions& options() const { return options_; }

 private:
  struct Connection {
    Mutex opening;  ///< Held while it is made, so that it is made once.
    std::shared_ptr<MemoryClient> client ENGRAM_GUARDED_BY(opening);
    std::vector<std::string> endpoints ENGRAM_GUARDED_BY(opening);  ///< Among which it was chosen.
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
  /// By memory.
  std::map<std::string, LastHolder, std::less<>> last_holders_ ENGRAM_GUARDED_BY(mutex_);
  std::map<std::string, std::shared_ptr<Connection>> connections_ ENGRAM_GUARDED_BY(mutex_);
  /// Of endpoints of other hosts, by server.
  std::map<std::string, size_t> tries_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::server
