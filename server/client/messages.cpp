// SPDX-License-Identifier: Apache-2.0
#include "server/client/messages.h"

#include <algorithm>

#include "server/wire/wire_snapshot.h"
#include "server/wire/wire_status.h"

namespace engram::server {

v1::QueryRequest to_request(const ltm::Query& query, const std::string& engine,
                            std::span<const SentContext> contexts) {
  v1::QueryRequest request;
  request.set_query(query.to_string());
  request.set_engine(engine);
  for (const SentContext& context : contexts) {
    v1::EntityContext& sent = *request.add_contexts();
    sent.set_entity(context.entity.to_string());
    sent.set_context(context.bytes);
  }
  return request;
}

v1::PredictionRequest to_request(const ltm::MemoryId& entity, std::span<const Duration> horizons,
                                 const PredictOptions& options) {
  v1::PredictionRequest request;
  request.set_entity(entity.to_string());
  for (const Duration horizon : horizons) request.add_horizons_ns(horizon.count());
  if (options.at) request.set_at_ns(to_ns(*options.at));
  if (options.plan) request.set_plan(options.plan->to_string());
  return request;
}

v1::EnginesRequest to_request(const ltm::MemoryId& entity, std::span<const Duration> horizons,
                              std::optional<Time> at) {
  v1::EnginesRequest request;
  request.set_entity(entity.to_string());
  for (const Duration horizon : horizons) request.add_horizons_ns(horizon.count());
  if (at) request.set_at_ns(to_ns(*at));
  return request;
}

Status take_part(v1::QueryReply& reply, ltm::QueryResult& answer) {
  ENGRAM_RETURN_IF_ERROR(to_status(reply.outcome()));
  for (v1::EntityAnswer& entity : *reply.mutable_entities()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto id, ltm::MemoryId::parse(entity.entity()));
    if (!id.is_entity()) return data_loss("answer: '{}' is no entity", entity.entity());
    ltm::EntityResult& one = answer.add_entity(id);
    for (v1::Snapshot& snapshot : *entity.mutable_snapshots()) {
      ENGRAM_ASSIGN_OR_RETURN(auto taken, take_answer(snapshot, {}));
      one.add(std::move(taken));
    }
  }
  return {};
}

Result<std::vector<ltm::SnapshotResult>> predictions_in(const ltm::QueryResult& answer,
                                                        const ltm::MemoryId& entity,
                                                        std::span<const Duration> horizons,
                                                        const PredictOptions& options) {
  const ltm::EntityResult* found = answer.find_entity(entity);
  if (found == nullptr || found->snapshots.empty())
    return not_found("entity '{}': has no snapshot to predict from", entity.to_string());
  std::vector<ltm::SnapshotResult> predicted;
  for (const Duration ahead : horizons) {
    const auto one = std::ranges::find_if(found->snapshots, [&](const ltm::SnapshotResult& told) {
      return told.source == ltm::Source::kPredicted && told.horizon == ahead;
    });
    // A server that does not know predictions from a moment tells the IDs of the newest snapshot.
    if (one == found->snapshots.end())
      return failed_precondition(
          "entity '{}': was asked for a prediction{}{}, but this server is of an earlier version, "
          "which predicts from the newest snapshot and without a plan",
          entity.to_string(), options.at ? " from " + to_string(*options.at) : "",
          options.plan ? " with the plan '" + options.plan->to_string() + "'" : "");
    predicted.push_back(*one);
  }
  return predicted;
}

Result<std::vector<std::vector<ltm::EngineRecord>>> engines_in(const v1::EnginesReply& reply,
                                                               const ltm::MemoryId& entity,
                                                               std::span<const Duration> horizons,
                                                               std::optional<Time> at) {
  if (at && !reply.has_at_ns())
    return failed_precondition(
        "entity '{}': was asked for the engines of an earlier moment, but this server is of an "
        "earlier version, which lists those of the newest one alone",
        entity.to_string());
  std::vector<std::vector<ltm::EngineRecord>> all(horizons.size());
  for (const v1::EnginesReply::Record& record : reply.records()) {
    const auto horizon = std::ranges::find(horizons, Duration(record.horizon_ns()));
    if (horizon == horizons.end()) continue;
    all[static_cast<size_t>(horizon - horizons.begin())].push_back(
        {record.engine(), record.model(), record.predictions(), to_error(record.mean()),
         to_error(record.bound())});
  }
  return all;
}

}  // namespace engram::server
