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

/// How long a server counts as there without a word from it.
struct Lease {
  Duration heartbeat_interval{};  ///< A heartbeat is due this often.
  Duration expires_after{};       ///< Without one for longer, the server is gone.
};

enum class NameEventKind : uint8_t {
  kArrived,
  kChanged,        ///< The same incarnation says something else of itself.
  kUnregistered,   ///< Left, and said so.
  kLostHeartbeat,  ///< Left without a word.
  kReplaced,       ///< Left: a newer incarnation of it arrives.
};

/// "arrived", "changed", "unregistered", "lost heartbeat", "replaced".
[[nodiscard]] std::string_view to_string(NameEventKind kind);

/// What happened to one server.
struct NameEvent {
  NameEventKind kind = NameEventKind::kArrived;
  Registration server;  ///< As it is from now on, or as it was.
};

/// How far a watcher has come. Those of another registry, such as one that was restarted since,
/// are told apart.
struct NameVersion {
  uint64_t registry = 0;
  uint64_t events = 0;

  friend bool operator==(const NameVersion&, const NameVersion&) = default;
};

/// What a watcher does not know yet.
struct NameChanges {
  NameVersion version;  ///< To ask with, the next time.
  /// True where the watcher is too far behind, or of another registry: `servers` is all there is.
  bool is_everything = false;
  std::vector<Registration> servers;  ///< Where is_everything.
  std::vector<NameEvent> events;      ///< Elsewhere, in the order in which they happened.
};

/// Which server has which memory: what the Memory Name System (MNS) knows.
///
/// Each memory is held by one server. A server registers, and then says at intervals that it is
/// still there; one that misses `max_missed` heartbeats is gone, and its memories are free. It
/// keeps nothing on disk: after a restart it is empty, and tells servers so at their next heartbeat
/// (kNotFound), upon which they register again.
///
/// Time: leases are counted by a steady clock, so that setting the machine's time ends none.
/// Threading: thread-safe.
class NameRegistry {
 public:
  struct Options {
    Duration heartbeat_interval = std::chrono::seconds(1);
    int max_missed = 3;
    size_t max_servers = 1024;
    RegistrationLimits registration;
    size_t max_events = 1024;  ///< That watchers may be behind.

    [[nodiscard]] Status validate() const;
  };

  /// `registry` tells this one from those before it: a random number, or the time of its start.
  /// Errors: kInvalidArgument.
  static Result<std::unique_ptr<NameRegistry>> create(const Options& options, uint64_t registry,
                                                      SteadyClock clock = steady_now);

  /// Takes a server in, or what one that is in says anew. A newer incarnation replaces an older.
  /// Errors: kInvalidArgument, see Registration::check; kAlreadyExists where another server, which
  /// it names, holds one of the memories; kFailedPrecondition where a newer incarnation is in;
  /// kResourceExhausted where there are too many servers. Nothing changes then.
  Result<Lease> add(const Registration& registration);

  /// Errors: kNotFound where the server is not in (any more): it is to register again;
  /// kFailedPrecondition where another incarnation is in.
  Result<Lease> heartbeat(std::string_view server, uint64_t incarnation);

  /// Errors: those of heartbeat.
  Status remove(std::string_view server, uint64_t incarnation);

  /// Lets go of servers that missed too many heartbeats; how many. All other calls do it too: this
  /// one is for watchers to be told in time.
  size_t expire();

  /// The server that holds a memory.
  /// Errors: kNotFound.
  Result<Registration> find(std::string_view memory);

  /// Those that hold what lies at or below an ID: one at most, or all for the empty one.
  std::vector<Registration> resolve(const ltm::MemoryId& id);

  /// Those that hold a memory whose name matches, by their names.
  std::vector<Registration> resolve(const ltm::NamePattern& memory);

  /// Waits for a memory that nobody holds yet.
  /// Errors: kUnavailable at `deadline`, kCancelled where `stop` is requested.
  Result<Registration> wait_for(std::string_view memory, SteadyTime deadline,
                                const std::stop_token& stop = {});

  /// What happened since `version`; everything for a version that is not known.
  NameChanges changes_since(const NameVersion& version);

  /// The same, after waiting for something to happen; without events where nothing did until
  /// `deadline`, or where `stop` is requested.
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
  std::deque<NameEvent> events_ ENGRAM_GUARDED_BY(mutex_);  ///< The last ones.
  uint64_t told_ ENGRAM_GUARDED_BY(mutex_) = 0;             ///< Events that there ever were.
  SteadyTime soonest_ ENGRAM_GUARDED_BY(mutex_){};          ///< No lease ends before.
};

}  // namespace engram::server
