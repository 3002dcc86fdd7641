// SPDX-License-Identifier: Apache-2.0
#include "tests/server/robot/client_example.h"

// [example]
#include "server/client/memory_client.h"  // link engram::client

using namespace engram;

Status remember_a_cup(const std::string& endpoint) {
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, server::MemoryClient::connect(endpoint));

  // What the robot sees from now on, told by a thread of the client.
  SubscriptionHandlers handlers;
  handlers.on_snapshots = [](std::vector<ToldSnapshot> told) {
    for (const ToldSnapshot& one : told) fmt::print("new: {}\n", one.snapshot.id().to_string());
  };
  ENGRAM_ASSIGN_OR_RETURN(const auto subscription,
                          memory->subscribe({.names = {"Objects"}}, handlers));

  // What is the case now; acknowledged when it survives `kill -9`.
  ENGRAM_ASSIGN_OR_RETURN(const auto cup, ltm::MemoryId::parse("Objects/Things/kitchen/cup"));
  const idf::Data value = idf::Dict{{"height", 0.11}};
  ENGRAM_RETURN_IF_ERROR(
      memory->commit({{{cup, system_now(), {{value, {}}}}}}, CommitDurability::kJournal));

  // What it was like, whichever form holds it.
  ENGRAM_ASSIGN_OR_RETURN(const auto query, ltm::Query::parse("Objects/.*/.*/cup @ last:10s"));
  ENGRAM_ASSIGN_OR_RETURN(const auto answer, memory->query(query));
  for (const ltm::EntityResult* entity : answer.entities())
    for (const ltm::SnapshotResult& snapshot : entity->snapshots)
      fmt::print("{}: {}\n", to_string(snapshot.time), ltm::to_string(snapshot.source));
  return {};
}
// [example]
