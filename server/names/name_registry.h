// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "ltm/memory/name_pattern.h"
#include "server/names/registration.h"

namespace engram::server {

/// How long a server counts as present without a heartbeat.
struct Lease {
  Duration heartbeat_interval{};  ///< A heartbeat is due at this interval.
  Duration expires_after{};       ///< Without a heartbeat for longer, the server is gone.
};

enum class NameEventKind : uint8_t {
  kArrived,
  kChanged,        ///< The same incarnation has changed its registration.
  kUnregistered,   ///< The server has left properly.
  kLostHeartbeat,  ///< The server has disappeared.
  kReplaced,       ///< A newer incarnation takes its place; kArrived follows.
};

/// "arrived", "changed", "unregistered", "lost heartbeat", "replaced".
[[nodiscard]] std::string_view to_string(NameEventKind kind);

/// A change of one server.
struct NameEvent {
  NameEventKind kind = NameEventKind::kArrived;
  Registration server;  ///< The new registration, or the last one of a server that left.
};

/// How far a watcher has followed the events. `registry` distinguishes registries, such as one
/// before a restart.
struct NameVersion {
  uint64_t registry = 0;
  uint64_t events = 0;

  friend bool operator==(const NameVersion&, const NameVersion&) = default;
};

/// The changes that a watcher does not know yet.
struct NameChanges {
  NameVersion version;  ///< The version to pass the next time.
  /// True if the watcher is too far behind or of another registry: `servers` then lists all
  /// servers.
  bool is_everything = false;
  std::vector<Registration> servers;  ///< Set if is_everything.
  std::vector<NameEvent> events;      ///< Set otherwise, in the order of their occurrence.
};

/// The state of the Memory Name System (MNS): which server has which memory.
///
/// Each memory is held by one server. A server registers and then sends heartbeats; a server that
/// misses `max_missed` heartbeats is gone, and its memories are free. Nothing is kept on disk:
/// after a restart the registry is empty and answers heartbeats with kNotFound, upon which servers
/// register again.
///
/// Time: leases use a steady clock, so that setting the machine's time ends none.
/// Threading: thread-safe.
class NameRegistry {
 public:
  struct Options {
    Duration heartbeat_interval = std::chrono::seconds(1);
    int max_missed = 3;
    size_t max_servers = 1024;
    RegistrationLimits registration;
    size_t max_events = 1024;  ///< Events kept for watchers that are behind.

    [[nodiscard]] Status validate() const;
  };

  /// `registry` distinguishes this registry from earlier ones: a random number, or its start time.
  /// Errors: kInvalidArgument.
  static Result<std::unique_ptr<NameRegistry>> create(const Options& options, uint64_t registry,
                                                      SteadyClock clock = steady_now);

  /// Registers a server, or updates a registered one. A newer incarnation replaces an older one.
  /// Errors: kInvalidArgument, see Registration::check; kAlreadyExists naming the other server that
  /// holds one of the memories; kFailedPrecondition if a newer incarnation is registered;
  /// kResourceExhausted if there are too many servers. After an error nothing has changed.
  Result<Lease> add(const Registration& registration);

  /// Renews the lease of a server.
  /// Errors: kNotFound if the server is not registered (any more) and must register again;
  /// kFailedPrecondition if another incarnation is registered.
  Result<Lease> heartbeat(std::string_view server, uint64_t incarnation);

  /// Removes a server.
  /// Errors: those of heartbeat().
  Status remove(std::string_view server, uint64_t incarnation);

  /// Removes servers that missed too many heartbeats and returns their number. Every other call
  /// does this too; this one exists so that watchers are notified in time.
  size_t expire();

  /// Returns the server that holds a memory.
  /// Errors: kNotFound if no server holds it.
  Result<Registration> find(std::string_view memory);

  /// Returns the servers that hold what lies at or below an ID: one at most, or all servers for the
  /// empty ID.
  std::vector<Registration> resolve(const ltm::MemoryId& id);

  /// Returns the servers that hold a memory with a matching name, ordered by server name.
  std::vector<Registration> resolve(const ltm::NamePattern& memory);

  /// Waits until a server holds a memory.
  /// Errors: kUnavailable at `deadline`; kCancelled if `stop` is requested.
  Result<Registration> wait_for(std::string_view memory, SteadyTime deadline,
                                const std::stop_token& stop = {});

  /// Returns the events since `version`, or all servers for an unknown version.
  NameChanges changes_since(const NameVersion& version);

  /// Like changes_since(), but waits for an event. Returns no events if none occurred until
  /// `deadline`, or if `stop` is requested.
  NameChanges wait_for_changes(const NameVersion& version, SteadyTime deadline,
                               const std::stop_token& stop = {});

 private:
  struct Entry {
    Registration registration;
    SteadyTime expires;
  };
  using Entries = std::map<std::string, Entry, std::less<>>;

  NameRegistry(const Options& options, uint64_t registry, SteadyClock clock);

  SteadyTime let_go_of_lost() ENGRAM_REQUIRES(mutex_);
  Status check_claims(const Registration& registration) const ENGRAM_REQUIRES(mutex_);
  Result<Entries::iterator> entry_of(std::string_view server, uint64_t incarnation)
      ENGRAM_REQUIRES(mutex_);
  void claim(const Registration& registration) ENGRAM_REQUIRES(mutex_);
  void release(const Registration& registration) ENGRAM_REQUIRES(mutex_);
  void let_go(Entries::iterator entry, NameEventKind reason) ENGRAM_REQUIRES(mutex_);
  void tell(NameEventKind kind, const Registration& server) ENGRAM_REQUIRES(mutex_);
  Lease renew(Entry& entry, SteadyTime now) const ENGRAM_REQUIRES(mutex_);
  const Entry* holder(std::string_view memory) const ENGRAM_REQUIRES(mutex_);
  std::vector<Registration> everything() const ENGRAM_REQUIRES(mutex_);
  NameChanges changes(const NameVersion& version) const ENGRAM_REQUIRES(mutex_);
  bool is_current(const NameVersion& version) const ENGRAM_REQUIRES(mutex_);

  const Options options_;
  const uint64_t registry_;
  const SteadyClock clock_;

  Mutex mutex_;
  StoppableCondition changed_;
  Entries entries_ ENGRAM_GUARDED_BY(mutex_);
  std::map<std::string, std::string, std::less<>> servers_of_memories_ ENGRAM_GUARDED_BY(mutex_);
  std::deque<NameEvent> events_ ENGRAM_GUARDED_BY(mutex_);  ///< The last `max_events` ones.
  uint64_t told_ ENGRAM_GUARDED_BY(mutex_) = 0;             ///< Number of all events so far.
  SteadyTime soonest_ ENGRAM_GUARDED_BY(mutex_){};          ///< No lease ends before this time.
};

}  // namespace engram::server
