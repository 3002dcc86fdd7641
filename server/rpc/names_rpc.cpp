// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/names_rpc.h"

#include <engram/v1/names.grpc.pb.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <set>
#include <thread>

#include "ltm/core/mutex.h"
#include "server/rpc/caller.h"
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

/// The max delay until a watcher learns of a lost heartbeat, or a waiting client of its deadline.
constexpr auto kLookEvery = std::chrono::milliseconds(100);
constexpr size_t kMaxWaiting = 4096;

v1::NameChanges to_message(const NameChanges& changes) {
  v1::NameChanges message;
  message.mutable_version()->set_registry(changes.version.registry);
  message.mutable_version()->set_events(changes.version.events);
  message.set_is_everything(changes.is_everything);
  for (const Registration& server : changes.servers)
    *message.add_servers() = server::to_message(server);
  for (const NameEvent& event : changes.events) {
    v1::NameEvent& one = *message.add_events();
    one.set_kind(static_cast<v1::NameEvent::Kind>(event.kind));
    *one.mutable_server() = server::to_message(event.server);
  }
  return message;
}

/// The stream that sends changes to one client.
class WatchStream final : public grpc::ServerWriteReactor<v1::NameChanges> {
 public:
  WatchStream(NameRegistry& names, const NameVersion& from) : names_(names), version_(from) {}

  /// Starts the stream, which deletes itself once it has ended and no thread uses it.
  void begin(std::shared_ptr<WatchStream> self) { self_ = std::move(self); }

  /// Sends what has changed. Returns false if the stream has ended.
  bool look() {
    const MutexLock lock(mutex_);
    if (is_finished_) return false;
    if (is_writing_) return true;
    const NameChanges changes = names_.changes_since(version_);
    if (!changes.is_everything && changes.events.empty()) return true;
    version_ = changes.version;
    written_ = to_message(changes);
    is_writing_ = true;
    // The write begins with the lock held, because nothing may begin after Finish().
    StartWrite(&written_);
    return true;
  }

  void end(const Status& status) {
    const MutexLock lock(mutex_);
    if (is_finished_) return;
    is_finished_ = true;
    Finish(to_grpc(status));
  }

  void OnWriteDone(bool ok) override {
    {
      const MutexLock lock(mutex_);
      is_writing_ = false;
    }
    if (ok)
      look();
    else
      end(cancelled("the watcher is gone"));
  }
  void OnCancel() override { end(cancelled("the watcher is gone")); }
  void OnDone() override { self_.reset(); }

 private:
  NameRegistry& names_;
  std::shared_ptr<WatchStream> self_;
  Mutex mutex_;
  NameVersion version_ ENGRAM_GUARDED_BY(mutex_);
  v1::NameChanges written_ ENGRAM_GUARDED_BY(mutex_);
  bool is_writing_ ENGRAM_GUARDED_BY(mutex_) = false;
  bool is_finished_ ENGRAM_GUARDED_BY(mutex_) = false;
};

/// A client that waits until a server registers a memory.
struct WaitingResolve {
  grpc::CallbackServerContext* call = nullptr;
  grpc::ServerUnaryReactor* reactor = nullptr;  ///< Kept, because a call hands it out only once.
  std::string memory;
  SteadyTime deadline;
  v1::ResolveReply* reply = nullptr;
};

class NamesRpc final : public v1::MemoryNameSystem::CallbackService {
 public:
  NamesRpc(NameRegistry& names, const AccessPolicy& access) : names_(names), access_(access) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }

  ~NamesRpc() override { thread_.request_stop(); }

  grpc::ServerUnaryReactor* Register(grpc::CallbackServerContext* call,
                                     const v1::ServerRecord* request,
                                     v1::RegisterReply* reply) override {
    const auto added = [&]() -> Result<Lease> {
      ENGRAM_ASSIGN_OR_RETURN(const Identity who, let_in(*call));
      const Registration registration = to_registration(*request);
      ENGRAM_RETURN_IF_ERROR(check_writes(who, registration.memories));
      return names_.add(registration);
    }();
    if (added.ok()) reply->set_heartbeat_interval_ns(added->heartbeat_interval.count());
    return finish(call, added.status());
  }

  grpc::ServerUnaryReactor* Heartbeat(grpc::CallbackServerContext* call,
                                      const v1::HeartbeatRequest* request,
                                      v1::HeartbeatReply* /*reply*/) override {
    const auto kept = [&]() -> Status {
      ENGRAM_RETURN_IF_ERROR(check_speaks_for(*call, request->server()));
      return names_.heartbeat(request->server(), request->incarnation()).status();
    };
    return finish(call, kept());
  }

  grpc::ServerUnaryReactor* Unregister(grpc::CallbackServerContext* call,
                                       const v1::UnregisterRequest* request,
                                       v1::UnregisterReply* /*reply*/) override {
    const auto removed = [&]() -> Status {
      ENGRAM_RETURN_IF_ERROR(check_speaks_for(*call, request->server()));
      return names_.remove(request->server(), request->incarnation());
    };
    return finish(call, removed());
  }

  grpc::ServerUnaryReactor* Resolve(grpc::CallbackServerContext* call,
                                    const v1::ResolveRequest* request,
                                    v1::ResolveReply* reply) override {
    if (const auto who = let_in(*call); !who.ok()) return finish(call, who.status());
    const auto servers = resolve(request->names());
    if (!servers.ok()) return finish(call, servers.status());
    for (const Registration& server : *servers) *reply->add_servers() = to_message(server);
    if (reply->servers_size() > 0 || request->wait_ns() <= 0 || request->names().empty())
      return finish(call, {});
    const MutexLock lock(mutex_);
    if (is_ending_) return finish(call, ended());
    if (resolves_.size() >= kMaxWaiting)
      return finish(call, resource_exhausted("name system: found {} clients that wait, needs fewer",
                                             kMaxWaiting));
    grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
    const auto wait = std::min<Duration>(Duration(request->wait_ns()), std::chrono::hours(1));
    resolves_.push_back({call, reactor, request->names(), steady_now() + wait, reply});
    return reactor;
  }

  grpc::ServerWriteReactor<v1::NameChanges>* Watch(grpc::CallbackServerContext* call,
                                                   const v1::WatchRequest* request) override {
    const NameVersion from{request->version().registry(), request->version().events()};
    auto stream = std::make_shared<WatchStream>(names_, from);
    stream->begin(stream);
    if (const auto who = let_in(*call); !who.ok()) {
      stream->end(who.status());
      return stream.get();
    }
    {
      const MutexLock lock(mutex_);
      if (is_ending_) {
        stream->end(ended());
        return stream.get();
      }
      if (watchers_.size() >= kMaxWaiting) {
        stream->end(resource_exhausted("name system: found {} watchers, needs fewer", kMaxWaiting));
        return stream.get();
      }
      watchers_.push_back(stream);
    }
    stream->look();
    return stream.get();
  }

 private:
  static grpc::ServerUnaryReactor* finish(grpc::CallbackServerContext* call, const Status& status) {
    grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
    reactor->Finish(to_grpc(status));
    return reactor;
  }

  /// Returns the servers of a memory; an empty text returns all, including servers without named
  /// memories.
  Result<std::vector<Registration>> resolve(const std::string& memory) {
    if (memory.empty()) return names_.resolve(ltm::MemoryId());
    ENGRAM_ASSIGN_OR_RETURN(const auto pattern, ltm::NamePattern::parse(memory));
    return names_.resolve(pattern);
  }

  static Status ended() { return unavailable("the name system stops"); }

  Result<Identity> let_in(const grpc::CallbackServerContext& call) const {
    ENGRAM_ASSIGN_OR_RETURN(Identity who, caller(access_, call));
    ENGRAM_RETURN_IF_ERROR(who.take_request(steady_now()));
    return who;
  }

  static Status check_writes(const Identity& who, const std::vector<std::string>& memories) {
    for (const std::string& memory : memories) {
      ENGRAM_ASSIGN_OR_RETURN(const auto id, ltm::MemoryId::from_names({memory}));
      ENGRAM_RETURN_IF_ERROR(who.check(Right::kWrite, id));
    }
    return {};
  }

  /// Checks that the caller may register this server: only such a caller may send its heartbeats or
  /// remove it.
  Status check_speaks_for(const grpc::CallbackServerContext& call, const std::string& server) {
    ENGRAM_ASSIGN_OR_RETURN(const Identity who, let_in(call));
    const auto all = names_.resolve(ltm::MemoryId());
    const auto known = std::ranges::find(all, server, &Registration::server);
    return known == all.end() ? Status() : check_writes(who, known->memories);
  }

  void run(const std::stop_token& stop) {
    NameVersion version;
    while (!stop.stop_requested()) {
      version = names_.wait_for_changes(version, steady_now() + kLookEvery, stop).version;
      answer_resolves(steady_now(), stop.stop_requested());
      std::vector<std::shared_ptr<WatchStream>> watchers;
      {
        const MutexLock lock(mutex_);
        watchers = watchers_;
      }
      for (const auto& watcher : watchers)
        if (!watcher->look()) {
          const MutexLock lock(mutex_);
          std::erase(watchers_, watcher);
        }
    }
    std::vector<std::shared_ptr<WatchStream>> watchers;
    {
      const MutexLock lock(mutex_);
      // Clients that arrive from here on are refused, since no thread would notify them.
      is_ending_ = true;
      watchers.swap(watchers_);
    }
    answer_resolves(steady_now(), true);
    for (const auto& watcher : watchers) watcher->end(ended());
  }

  void answer_resolves(SteadyTime now, bool is_ending) ENGRAM_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    std::erase_if(resolves_, [&](WaitingResolve& waiting) {
      const auto servers = resolve(waiting.memory).value_or({});
      if (servers.empty() && now < waiting.deadline && !is_ending && !waiting.call->IsCancelled())
        return false;
      for (const Registration& server : servers) *waiting.reply->add_servers() = to_message(server);
      waiting.reactor->Finish(grpc::Status::OK);
      return true;
    });
  }

  NameRegistry& names_;
  const AccessPolicy& access_;
  Mutex mutex_;
  std::vector<WaitingResolve> resolves_ ENGRAM_GUARDED_BY(mutex_);
  std::vector<std::shared_ptr<WatchStream>> watchers_ ENGRAM_GUARDED_BY(mutex_);
  bool is_ending_ ENGRAM_GUARDED_BY(mutex_) = false;
  std::jthread thread_;  ///< Declared last, so that it ends first.
};

}  // namespace

v1::ServerRecord to_message(const Registration& registration) {
  v1::ServerRecord message;
  message.set_server(registration.server);
  for (const std::string& memory : registration.memories) message.add_memories(memory);
  for (const std::string& endpoint : registration.endpoints) message.add_endpoints(endpoint);
  message.set_incarnation(registration.incarnation);
  return message;
}

Registration to_registration(const v1::ServerRecord& message) {
  Registration registration;
  registration.server = message.server();
  registration.memories.assign(message.memories().begin(), message.memories().end());
  registration.endpoints.assign(message.endpoints().begin(), message.endpoints().end());
  registration.incarnation = message.incarnation();
  return registration;
}

std::unique_ptr<grpc::Service> make_names_rpc(NameRegistry& names, const AccessPolicy& access) {
  return std::make_unique<NamesRpc>(names, access);
}

}  // namespace engram::server
