// SPDX-License-Identifier: Apache-2.0
#include "server/client/commit_sender.h"

#include <algorithm>

#include "server/client/awaited.h"
#include "server/wire/byte_message.h"
#include "server/wire/wire_block.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

namespace {

/// How long the client waits before it asks again for shared memory that the server did not offer.
constexpr auto kShareAgainAfter = std::chrono::seconds(1);
/// As many as a server is believed to have.
constexpr size_t kMaxSensorySegments = 1024;

v1::Durability to_message(CommitDurability durability) {
  return static_cast<v1::Durability>(durability);
}

}  // namespace

CommitSender::CommitSender(const ClientOptions& options, std::string endpoint, bool shares_memory,
                           std::shared_ptr<grpc::Channel> channel, v1::MemoryServer::Stub& stub)
    : options_(options),
      endpoint_(std::move(endpoint)),
      shares_memory_(shares_memory),
      channel_(std::move(channel)),
      stub_(stub),
      calls_(std::make_shared<CommitCalls>(channel_, "/engram.v1.MemoryServer/Commit",
                                           options.token)) {}

void CommitSender::close() {
  calls_->close();
  const MutexLock lock(sharing_mutex_);
  if (sharing_.calls) sharing_.calls->close();
}

void CommitSender::send(const ltm::Commit& commit, CommitDurability durability, const Done& done) {
  if (hold(commit, durability, done) || share(commit, durability, done)) return;
  v1::CommitRequest request;
  request.set_durability(to_message(durability));
  for (const ltm::EntityUpdate& update : commit.updates) {
    auto message = to_message(update);
    if (!message.ok()) {
      done(message.status());
      return;
    }
    *request.add_updates() = *std::move(message);
  }
  send(*calls_, request,
       {[this, done](v1::CommitReply& reply) {
          learn(reply);
          done(to_status(reply.outcome()));
          return true;
        },
        done});
}

CommitSender::SharedCommits CommitSender::shared() {
  const MutexLock lock(sharing_mutex_);
  if (sharing_.lane && sharing_.lane->is_alive()) return sharing_;
  if (sharing_.calls) sharing_.calls->close();
  sharing_ = {};
  if (!shares_memory_ || steady_now() < share_again_) return {};
  sharing_.lane = SharedLane::open(stub_, options_);
  if (!sharing_.lane) {
    share_again_ = steady_now() + kShareAgainAfter;
    return {};
  }
  sharing_.calls = std::make_shared<CommitCalls>(channel_, "/engram.v1.MemoryServer/Commit",
                                                 options_.token, sharing_.lane->session());
  sharing_.sensory = std::make_shared<SensoryLane>(
      sharing_.lane, [this, calls = sharing_.calls](v1::CommitRequest request) {
        return ask(*calls, std::move(request));
      });
  return sharing_;
}

Result<v1::CommitReply> CommitSender::ask(CommitCalls& calls, v1::CommitRequest request) {
  auto awaited = std::make_shared<Awaited<Result<v1::CommitReply>>>();
  send(calls, request,
       {[awaited](v1::CommitReply& reply) {
          if (const Status status = to_status(reply.outcome()); !status.ok())
            awaited->set(status);
          else
            awaited->set(std::move(reply));
          return true;
        },
        [awaited](const Status& status) { awaited->set(status); }});
  return wait_for(awaited, steady_now() + options_.timeout, [this] {
    return unavailable("server '{}': no answer within {}", endpoint_, to_string(options_.timeout));
  });
}

void CommitSender::send(CommitCalls& calls, v1::CommitRequest& request,
                        CommitCalls::Pending pending) {
  calls.call(
      [&request](uint64_t number) {
        request.set_number(number);
        return to_bytes(request);
      },
      std::move(pending));
}

void CommitSender::learn(const v1::CommitReply& reply) {
  if (!shares_memory_ || reply.sensory_size() == 0) return;
  const ExclusiveLock lock(sensory_mutex_);
  for (const std::string& text : reply.sensory()) {
    auto id = ltm::MemoryId::parse(text);
    if (!id.ok() || std::ranges::find(sensory_, *id) != sensory_.end()) continue;
    if (sensory_.size() >= kMaxSensorySegments) return;
    sensory_.push_back(*std::move(id));
    has_sensory_ = true;
  }
}

bool CommitSender::is_sensory(const ltm::Commit& commit) {
  if (!has_sensory_) return false;
  const SharedLock lock(sensory_mutex_);
  return std::ranges::all_of(
      commit.updates,
      [this](const ltm::EntityUpdate& update) ENGRAM_REQUIRES_SHARED(sensory_mutex_) {
        return std::ranges::any_of(
            sensory_, [&](const ltm::MemoryId& id) { return id.is_prefix_of(update.entity); });
      });
}

bool CommitSender::hold(const ltm::Commit& commit, CommitDurability durability, const Done& done) {
  if (durability == CommitDurability::kJournal || !is_sensory(commit) || !commit.check().ok())
    return false;
  const SharedCommits with = shared();
  if (!with.sensory) return false;
  auto written = with.sensory->write(commit);
  if (!written) return false;
  if (!written->ok() || !(*written)->is_attended) {
    done(written->status());
    return true;
  }
  v1::CommitRequest request;
  *request.mutable_entry() = (*written)->entry;
  send(*with.calls, request,
       {[done](v1::CommitReply& reply) {
          done(to_status(reply.outcome()));
          return true;
        },
        done});
  return true;
}

std::optional<BlockRef> CommitSender::lease(const SharedCommits& with, const std::string& memory,
                                            size_t bytes) {
  // A lease of an earlier commit saves a round trip to the server before this commit.
  if (auto kept = with.lane->take_lease(memory, bytes)) return kept;
  v1::CommitRequest request;
  request.set_lease_bytes(bytes);
  request.set_lease_memory(memory);
  const auto reply = ask(*with.calls, std::move(request));
  return reply.ok() && reply->has_block() ? std::optional(to_block(reply->block())) : std::nullopt;
}

bool CommitSender::share(const ltm::Commit& commit, CommitDurability durability, const Done& done) {
  const size_t bytes = bytes_in_block(commit);
  const auto memory = memory_of(commit);
  // A block belongs to one memory, because its readers can read all of it.
  if (bytes < kSharedPayloadBytes || !memory) return false;
  const SharedCommits with = shared();
  if (!with.lane) return false;
  const auto block = lease(with, *memory, bytes);
  if (!block) return false;
  const auto out = with.lane->memory().writable(*block);
  if (!out.ok()) return false;
  v1::CommitRequest request;
  request.set_durability(to_message(durability));
  if (const Status written = write_in_block(commit, *out, request); !written.ok()) {
    with.lane->keep_lease(*memory, *block);
    done(written);
    return true;
  }
  *request.mutable_block() = to_message(*block);
  request.set_lease_bytes(bytes);
  request.set_lease_memory(*memory);
  send(*with.calls, request,
       {[this, done, lane = with.lane, memory = *memory](v1::CommitReply& reply) {
          learn(reply);
          if (reply.has_block()) lane->keep_lease(memory, to_block(reply.block()));
          done(to_status(reply.outcome()));
          return true;
        },
        done});
  return true;
}

Result<Loan> CommitSender::lend(std::span<const ArrayToLend> arrays) {
  ENGRAM_RETURN_IF_ERROR(check_loan(arrays));
  const ltm::Commit named = commit_of(arrays);
  if (!named.updates.empty() && is_sensory(named)) {
    const SharedCommits with = shared();
    if (with.sensory)
      if (auto lent = with.sensory->lend(arrays, named)) return *std::move(lent);
  }
  return Loan::in_this_process(arrays);
}

}  // namespace engram::server
