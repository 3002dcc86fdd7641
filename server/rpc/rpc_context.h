// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "ltm/core/mutex.h"
#include "ltm/redaction/redactor.h"
#include "memory/live/event_hub.h"
#include "memory/live/memory_service.h"
#include "server/access/access_policy.h"
#include "server/access/audit_log.h"
#include "server/rpc/rpc_metrics.h"
#include "server/rpc/sensory_rings.h"
#include "server/rpc/shared_sessions.h"
#include "server/rpc/work_queue.h"
#include "server/skills/skill_memory.h"

namespace engram::server {

/// The state that all streams of one server share.
///
/// Threading: thread-safe.
struct RpcContext {
  RpcContext(memory::MemoryService& served, AccessPolicy who_may, int threads)
      : service(served), access(std::move(who_may)), work(threads) {}

  memory::MemoryService& service;
  const AccessPolicy access;
  std::unique_ptr<ltm::Redactor> redactor;  ///< Of answers; null: nobody needs it.
  std::shared_ptr<AuditLog> audit;          ///< Null: nobody keeps one.
  memory::EventHub hub;
  RpcMetrics metrics;
  /// The rings of clients that share memory. Declared first, because sharing tells of clients that
  /// are gone.
  SensoryRings rings{*this};
  std::unique_ptr<SharedSessions> sharing;  ///< Null: no shared memory.
  /// The skill memory of this server, which starts when it is first needed; empty: it has none. It
  /// outlives all streams.
  std::function<Result<skills::SkillMemory*>()> skills;
  /// The same, if it has started; null if not.
  std::function<skills::SkillMemory*()> started_skills;
  std::atomic<int> forgettings{0};    ///< Calls that forget, or look up what they may.
  std::atomic<int> similar_calls{0};  ///< Questions about likeness that are not answered yet.
  std::atomic<int> streams{0};
  int max_streams = 4096;
  /// Max streams of one token, so that other tokens still find room.
  int max_streams_of_one = 1024;
  Mutex counting;
  /// Keyed by the token's name.
  std::map<std::string, int> streams_of ENGRAM_GUARDED_BY(counting);
  memory::MemoryService::Durability durability = memory::MemoryService::Durability::kMemory;
  /// Runs work that takes too long for a stream's thread. Declared last, as is the next one, so
  /// that they end first.
  WorkQueue work;
  /// Answers questions about likeness, which may take minutes: queries need not wait for them.
  WorkQueue comparing{1};

  /// Notes what somebody asked, and whether `outcome` lets them. Returns `outcome`.
  /// Errors: kFailedPrecondition if it cannot be noted; then nothing may be given out.
  Status audited(const std::string& who, std::string_view did, std::string_view on,
                 Status outcome) {
    if (!audit) return outcome;
    const Status noted = audit->add({service.options().name, who, std::string(did), std::string(on),
                                     std::string(outcome.message())});
    // No client should wait and try again, as it does where a server is not there for a moment.
    if (!noted.ok())
      return failed_precondition("what cannot be noted is refused: {}", noted.message());
    return outcome;
  }

  /// Counts a request against the rate of who asks. A refusal is counted and noted.
  /// Errors: those of Identity::take_request.
  Status take_request(const Identity& who, std::string_view did) {
    Status status = who.take_request(steady_now());
    if (status.ok()) return status;
    metrics.refused_rates.add();
    return audited(who.name(), did, "", std::move(status));
  }
};

/// Counts a stream while it lives.
class StreamSlot {
 public:
  StreamSlot(RpcContext& context, const Identity& who) : context_(context), name_(who.name()) {
    count(1);
  }
  ~StreamSlot() { count(-1); }
  StreamSlot(const StreamSlot&) = delete;
  StreamSlot& operator=(const StreamSlot&) = delete;

 private:
  void count(int more) {
    context_.streams += more;
    context_.metrics.streams.add(more);
    const MutexLock lock(context_.counting);
    int& of_one = context_.streams_of[name_];
    of_one += more;
    if (of_one == 0) context_.streams_of.erase(name_);
  }

  RpcContext& context_;
  const std::string name_;
};

}  // namespace engram::server
