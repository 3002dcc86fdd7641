// SPDX-License-Identifier: Apache-2.0
#include "server/names/name_registry.h"

#include <algorithm>

namespace engram::server {

std::string_view to_string(NameEventKind kind) {
  switch (kind) {
    case NameEventKind::kArrived:
      return "arrived";
    case NameEventKind::kChanged:
      return "changed";
    case NameEventKind::kUnregistered:
      return "unregistered";
    case NameEventKind::kLostHeartbeat:
      return "lost heartbeat";
    case NameEventKind::kReplaced:
      break;
  }
  return "replaced";
}

Status NameRegistry::Options::validate() const {
  if (heartbeat_interval <= Duration(0) || heartbeat_interval > std::chrono::hours(1))
    return invalid_argument(
        "name registry: found heartbeats every {}, needs more than 0s, at most "
        "1h",
        engram::to_string(heartbeat_interval));
  if (max_missed < 1 || max_missed > 1000)
    return invalid_argument("name registry: found {} heartbeats to miss, needs 1 to 1000",
                            max_missed);
  if (max_servers == 0) return invalid_argument("name registry: found 0 servers, needs more");
  if (max_events == 0) return invalid_argument("name registry: found 0 events, needs more");
  return registration.validate();
}

NameRegistry::NameRegistry(const Options& options, uint64_t registry, SteadyClock clock)
    : options_(options), registry_(registry), clock_(std::move(clock)) {}

Result<std::unique_ptr<NameRegistry>> NameRegistry::create(const Options& options,
                                                           uint64_t registry, SteadyClock clock) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return std::unique_ptr<NameRegistry>(new NameRegistry(options, registry, std::move(clock)));
}

Result<Lease> NameRegistry::add(const Registration& registration) {
  ENGRAM_RETURN_IF_ERROR(registration.check(options_.registration));
  const MutexLock lock(mutex_);
  const SteadyTime now = let_go_of_lost();
  ENGRAM_RETURN_IF_ERROR(check_claims(registration));
  auto entry = entries_.find(registration.server);
  if (entry != entries_.end() &&
      entry->second.registration.incarnation < registration.incarnation) {
    let_go(entry, NameEventKind::kReplaced);
    entry = entries_.end();
  }
  if (entry == entries_.end()) {
    entry = entries_.emplace(registration.server, Entry{registration, now}).first;
    claim(registration);
    tell(NameEventKind::kArrived, registration);
  } else if (entry->second.registration != registration) {
    release(entry->second.registration);
    entry->second.registration = registration;
    claim(registration);
    tell(NameEventKind::kChanged, registration);
  }
  const Lease lease = renew(entry->second, now);
  soonest_ = std::min(soonest_, entry->second.expires);
  return lease;
}

Result<Lease> NameRegistry::heartbeat(std::string_view server, uint64_t incarnation) {
  const MutexLock lock(mutex_);
  const SteadyTime now = let_go_of_lost();
  ENGRAM_ASSIGN_OR_RETURN(const auto entry, entry_of(server, incarnation));
  return renew(entry->second, now);
}

Status NameRegistry::remove(std::string_view server, uint64_t incarnation) {
  const MutexLock lock(mutex_);
  let_go_of_lost();
  ENGRAM_ASSIGN_OR_RETURN(const auto entry, entry_of(server, incarnation));
  let_go(entry, NameEventKind::kUnregistered);
  return {};
}

size_t NameRegistry::expire() {
  const MutexLock lock(mutex_);
  const size_t before = entries_.size();
  let_go_of_lost();
  return before - entries_.size();
}

Result<Registration> NameRegistry::find(std::string_view memory) {
  const MutexLock lock(mutex_);
  let_go_of_lost();
  if (const Entry* entry = holder(memory)) return entry->registration;
  return not_found("memory '{}': no server that is registered holds it", memory);
}

std::vector<Registration> NameRegistry::resolve(const ltm::MemoryId& id) {
  const MutexLock lock(mutex_);
  let_go_of_lost();
  if (id.names().empty()) return everything();
  const Entry* entry = holder(id.names().front());
  if (entry == nullptr) return {};
  return {entry->registration};
}

std::vector<Registration> NameRegistry::resolve(const ltm::NamePattern& memory) {
  const MutexLock lock(mutex_);
  let_go_of_lost();
  std::vector<Registration> servers;
  const auto matches = [&](const std::string& name) { return memory.matches(name); };
  for (const auto& [name, entry] : entries_)
    if (std::ranges::any_of(entry.registration.memories, matches))
      servers.push_back(entry.registration);
  return servers;
}

Result<Registration> NameRegistry::wait_for(std::string_view memory, SteadyTime deadline,
                                            const std::stop_token& stop) {
  const MutexLock lock(mutex_);
  const auto is_held = [&]() ENGRAM_REQUIRES(mutex_) {
    let_go_of_lost();
    return holder(memory) != nullptr;
  };
  if (changed_.wait_until(mutex_, stop, deadline, is_held)) return holder(memory)->registration;
  if (stop.stop_requested()) return cancelled("memory '{}': asked to wait no longer", memory);
  return unavailable("memory '{}': no server that holds it came in time", memory);
}

NameChanges NameRegistry::changes_since(const NameVersion& version) {
  const MutexLock lock(mutex_);
  let_go_of_lost();
  return changes(version);
}

NameChanges NameRegistry::wait_for_changes(const NameVersion& version, SteadyTime deadline,
                                           const std::stop_token& stop) {
  const MutexLock lock(mutex_);
  changed_.wait_until(mutex_, stop, deadline, [&]() ENGRAM_REQUIRES(mutex_) {
    let_go_of_lost();
    return !is_current(version);
  });
  return changes(version);
}

SteadyTime NameRegistry::let_go_of_lost() {
  const SteadyTime now = clock_();
  // Every call comes here first, so leases need no thread of their own. `soonest_` spares the scan
  // of all servers until a lease can have ended.
  if (now <= soonest_) return now;
  soonest_ = SteadyTime::max();
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    const auto next = std::next(entry);
    if (now > entry->second.expires)
      let_go(entry, NameEventKind::kLostHeartbeat);
    else
      soonest_ = std::min(soonest_, entry->second.expires);
    entry = next;
  }
  return now;
}

Status NameRegistry::check_claims(const Registration& registration) const {
  const auto same = entries_.find(registration.server);
  if (same == entries_.end() && entries_.size() >= options_.max_servers)
    return resource_exhausted("server '{}': {} servers are registered, at most {} are taken",
                              registration.server, entries_.size(), options_.max_servers);
  if (same != entries_.end() && same->second.registration.incarnation > registration.incarnation)
    return failed_precondition(
        "server '{}': its incarnation {} is registered, found the older one {}",
        registration.server, same->second.registration.incarnation, registration.incarnation);
  for (const std::string& memory : registration.memories) {
    const Entry* entry = holder(memory);
    if (entry != nullptr && entry->registration.server != registration.server)
      return already_exists("memory '{}': server '{}' at '{}' holds it, server '{}' may not too",
                            memory, entry->registration.server,
                            entry->registration.endpoints.front(), registration.server);
  }
  return {};
}

Result<NameRegistry::Entries::iterator> NameRegistry::entry_of(std::string_view server,
                                                               uint64_t incarnation) {
  const auto entry = entries_.find(server);
  if (entry == entries_.end())
    return not_found("server '{}': is not registered (any more), needs to register again", server);
  const uint64_t found = entry->second.registration.incarnation;
  if (found != incarnation)
    return failed_precondition("server '{}': its incarnation {} is registered, not {}", server,
                               found, incarnation);
  return entry;
}

void NameRegistry::claim(const Registration& registration) {
  for (const std::string& memory : registration.memories)
    servers_of_memories_[memory] = registration.server;
}

void NameRegistry::release(const Registration& registration) {
  for (const std::string& memory : registration.memories) servers_of_memories_.erase(memory);
}

void NameRegistry::let_go(Entries::iterator entry, NameEventKind reason) {
  release(entry->second.registration);
  tell(reason, entry->second.registration);
  entries_.erase(entry);
}

void NameRegistry::tell(NameEventKind kind, const Registration& server) {
  events_.push_back({kind, server});
  if (events_.size() > options_.max_events) events_.pop_front();
  ++told_;
  changed_.notify_all();
}

Lease NameRegistry::renew(Entry& entry, SteadyTime now) const {
  const Lease lease{options_.heartbeat_interval, options_.heartbeat_interval * options_.max_missed};
  // A heartbeat never shortens a lease.
  entry.expires = std::max(entry.expires, now + lease.expires_after);
  return lease;
}

const NameRegistry::Entry* NameRegistry::holder(std::string_view memory) const {
  const auto server = servers_of_memories_.find(memory);
  return server == servers_of_memories_.end() ? nullptr : &entries_.find(server->second)->second;
}

std::vector<Registration> NameRegistry::everything() const {
  std::vector<Registration> servers;
  for (const auto& [name, entry] : entries_) servers.push_back(entry.registration);
  return servers;
}

bool NameRegistry::is_current(const NameVersion& version) const {
  return version == NameVersion{registry_, told_};
}

NameChanges NameRegistry::changes(const NameVersion& version) const {
  NameChanges changes{{registry_, told_}, false, {}, {}};
  if (is_current(version)) return changes;
  // A version of another registry counts other events. More events than were kept cannot be
  // replayed. In both cases the watcher needs the full list.
  if (version.registry != registry_ || version.events > told_ ||
      told_ - version.events > events_.size()) {
    changes.is_everything = true;
    changes.servers = everything();
    return changes;
  }
  const auto behind = static_cast<std::ptrdiff_t>(told_ - version.events);
  changes.events.assign(events_.end() - behind, events_.end());
  return changes;
}

}  // namespace engram::server
