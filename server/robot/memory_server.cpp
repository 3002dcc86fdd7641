// SPDX-License-Identifier: Apache-2.0
#include "server/robot/memory_server.h"

#include <algorithm>

#include "ltm/core/log.h"
#include "ltm/skills/skill_ids.h"
#include "server/client/names_client.h"
#include "server/rpc/in_process_memory.h"
#include "server/rpc/memory_rpc.h"

namespace engram::server {

struct MemoryServer::State {
  std::vector<Endpoint> reached_at;
  uint64_t started = 0;
  std::unique_ptr<memory::MemoryService> service;
  std::unique_ptr<RpcContext> context;
  std::unique_ptr<SkillHost> skills;  ///< Null: the server has none. Outlives all streams.
  std::unique_ptr<grpc::Service> rpc;
  std::unique_ptr<RpcServer> server;
  std::unique_ptr<Registrar> registrar;
};

namespace {

bool may_have_skills(const MemoryServer::Options& options) {
  const auto& memories = options.service.memories;
  return options.skills &&
         (memories.empty() || std::ranges::find(memories, skills::kSkillMemory) != memories.end());
}

void start_skill_host(const MemoryServer::Options& options, RpcContext& context,
                      std::unique_ptr<SkillHost>& host) {
  // Where nothing of every snapshot is kept, there is nothing to wait for.
  const bool is_kept =
      options.service.store && options.service.memory.mode != ltm::StoreMode::kLatest;
  const skills::SkillMemory::Options skilled{
      .durability = is_kept ? CommitDurability::kJournal : CommitDurability::kMemory,
      .clock = options.skills->clock,
      // What is asked before it has started is carried out all the same.
      .carries_out_since = system_now()};
  SkillHost::OpenMemory open = options.skills->open;
  if (!open) open = [&context] { return Result(in_process_memory(context)); };
  host = std::make_unique<SkillHost>(std::move(open), skilled);
  context.skills = [&host = *host] { return host.get(); };
  context.started_skills = [&host = *host] { return host.started(); };
  host->start_on_request(context.hub);
}

}  // namespace

MemoryServer::MemoryServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

MemoryServer::~MemoryServer() {
  const Status status = stop();
  if (!status.ok()) log::warning("{}", status.to_string());
}

Result<std::unique_ptr<MemoryServer>> MemoryServer::start(const Options& options,
                                                          ltm::ModelLoader loader,
                                                          NamesClient* names) {
  auto state = std::make_unique<State>();
  state->reached_at = options.reached_at;
  state->started = static_cast<uint64_t>(to_ns(system_now()));
  auto access = AccessPolicy::everyone();
  if (!options.tokens.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(access, AccessPolicy::read_file(options.tokens));
  }
  std::unique_ptr<ltm::Redactor> redactor;
  if (access.redaction()) {
    ENGRAM_ASSIGN_OR_RETURN(redactor, ltm::Redactor::create({{{}, access.redaction()}}));
  }
  ENGRAM_ASSIGN_OR_RETURN(state->service,
                          memory::MemoryService::open(options.service, std::move(loader)));
  state->context =
      std::make_unique<RpcContext>(*state->service, std::move(access), options.threads);
  state->context->redactor = std::move(redactor);
  state->context->durability = options.durability;
  state->context->audit = options.audit;
  for (const Endpoint& endpoint : options.rpc.endpoints) {
    if (!options.sharing || endpoint.kind() != Endpoint::Kind::kUnix) continue;
    ENGRAM_ASSIGN_OR_RETURN(
        state->context->sharing,
        SharedSessions::start(
            endpoint.path() + ".memory", *options.sharing,
            [context = state->context.get()](const std::string& who, const std::string& memory) {
              return context->audited(who, "share", memory, {});
            },
            [context = state->context.get()](ClientId client) { context->rings.end(client); }));
    break;
  }
  if (may_have_skills(options)) start_skill_host(options, *state->context, state->skills);
  state->service->tell_of_passed(
      [told = state->context.get()](std::span<const ltm::SharedSnapshot> passed) {
        publish(*told, passed);
      });
  state->rpc = make_memory_rpc(*state->context);
  ENGRAM_ASSIGN_OR_RETURN(state->server, RpcServer::start(options.rpc, {state->rpc.get()}));
  ENGRAM_RETURN_IF_ERROR(state->context->audited(
      "", "serve", fmt::format("{}", fmt::join(state->server->endpoints(), " ")), {}));
  RpcContext& context = *state->context;
  state->service->tell_of_below(
      {.is_wanted =
           [&context](const ltm::MemoryId& entity) {
             return context.hub.listeners(entity) != nullptr;
           },
       .publish =
           [&context](std::span<const ltm::SharedSnapshot> told) { publish(context, told); }});
  auto server = std::unique_ptr<MemoryServer>(new MemoryServer(std::move(state)));
  if (names != nullptr)
    server->state_->registrar = std::make_unique<Registrar>(*names, server->registration());
  return server;
}

std::vector<std::string> MemoryServer::endpoints() const {
  return state_->server->endpoints();
}

memory::MemoryService& MemoryServer::service() {
  return *state_->service;
}

Registration MemoryServer::registration() const {
  const memory::MemoryService::Options& options = state_->service->options();
  Registration said{options.name, options.memories, {}, state_->started};
  for (const Endpoint& endpoint : state_->reached_at)
    said.endpoints.push_back(endpoint.to_string());
  if (said.endpoints.empty()) said.endpoints = endpoints();
  return said;
}

Status MemoryServer::begin_skills() {
  if (!state_->skills) return {};
  const auto& memories = state_->service->options().memories;
  const bool is_its_memory = std::ranges::find(memories, skills::kSkillMemory) != memories.end();
  ENGRAM_ASSIGN_OR_RETURN(
      const auto what_is_there,
      ltm::Query::parse(fmt::format("?ids {}/.*/.*/.* @ latest", skills::kSkillMemory)));
  if (!is_its_memory && !state_->service->query(what_is_there).ok()) return {};
  return state_->skills->get().status();
}

Status MemoryServer::commit(ltm::Commit commit) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Admission admission,
                          state_->service->commit(std::move(commit)));
  publish(*state_->context, admission.snapshots);
  return {};
}

Status MemoryServer::stop() {
  if (!state_->server) return {};
  state_->registrar.reset();
  // Providers are told to stop while their streams are still there.
  if (state_->skills) state_->skills->close();
  state_->server->stop(std::chrono::milliseconds(200));
  state_->server.reset();
  // A store is closed even where the log cannot tell of it.
  if (const Status noted = state_->context->audited("", "stop", "", {}); !noted.ok())
    log::warning("audit log: {}", noted.message());
  return state_->service->close();
}

}  // namespace engram::server
