// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/figures.h"

#include <nlohmann/json.hpp>

#include "server/rpc/connection_guard.h"

namespace engram::server {

namespace {

struct Figure {
  std::string name;
  std::string help;
  double value = 0;
};

std::vector<Figure> figures(const memory::MemoryService::Counters& counters) {
  const ltm::MemoryCounters& memory = counters.memory;
  const auto number = [](auto value) { return static_cast<double>(value); };
  std::vector<Figure> all = {
      {"memory_entities", "Entities in working memory.", number(memory.entities)},
      {"memory_snapshots", "Snapshots in working memory.", number(memory.snapshots)},
      {"memory_bytes", "Bytes of those that stay.", number(memory.bytes)},
      {"memory_waiting", "Snapshots that wait for the online phase.", number(memory.waiting)},
      {"memory_waiting_bytes", "Bytes of these.", number(memory.waiting_bytes)},
      {"memory_committed", "Snapshots that were committed.", number(memory.committed)},
      {"memory_superseded", "Replaced by another of the same time.", number(memory.superseded)},
      {"memory_left", "Gone from memory, stored.", number(memory.left)},
      {"memory_dropped", "Gone from memory, not stored.", number(memory.dropped)},
      {"memory_forgotten", "Taken out for good.", number(memory.forgotten)},
      {"memory_stored", "Taken by the online phase.", number(memory.stored)},
      {"memory_refused", "Commits that were not taken.", number(memory.refused)},
      {"memory_reads", "Snapshots given out with their data.", number(memory.reads)},
      {"queries", "Queries answered.", number(counters.queries)},
      {"queries_of_store", "That the store was needed for.", number(counters.queries_of_store)},
      {"predictions", "Moments predicted.", number(counters.predictions)},
      {"store_failures", "Attempts to store that failed.", number(counters.store_failures)}};
  const ltm::RedactionCounters& redaction = counters.redaction;
  if (redaction.images + redaction.dropped > 0) {
    all.push_back({"redact_images", "Images that detectors looked at.", number(redaction.images)});
    all.push_back({"redact_redacted", "Images that were redacted.", number(redaction.redacted)});
    all.push_back({"redact_boxes", "Boxes that were found.", number(redaction.boxes)});
    all.push_back({"redact_dropped", "Snapshots dropped by redaction.", number(redaction.dropped)});
    all.push_back({"redact_unanswered", "Of these, without an answer of the detector.",
                   number(redaction.unanswered)});
    all.push_back({"redact_unreadable", "Of these, with images in which no detector looks.",
                   number(redaction.unreadable)});
  }
  if (counters.sensory) {
    const memory::SensoryCounts& sensory = *counters.sensory;
    all.push_back({"sensory_committed", "Snapshots of sensory segments that came.",
                   number(sensory.committed)});
    all.push_back({"sensory_passed", "Of these, to working memory.", number(sensory.passed)});
    all.push_back(
        {"sensory_refused", "That were to pass and were refused.", number(sensory.refused)});
    all.push_back({"sensory_lost", "To which nobody attended.", number(sensory.lost())});
    all.push_back({"sensory_crowded_out", "Lost before their time, since a ring was full.",
                   number(sensory.crowded_out)});
    all.push_back({"sensory_held", "That can still pass.", number(sensory.held)});
    all.push_back(
        {"sensory_bytes", "Bytes of those that can still pass.", number(sensory.held_bytes)});
  }
  if (!counters.store) return all;
  const memory::LongTerm::Counters& store = *counters.store;
  const ltm::StorePast::Counters& reading = counters.reading;
  all.push_back(
      {"store_recorded", "Snapshots that the online phase took.", number(store.recorded)});
  all.push_back({"store_refused", "That it will never take.", number(store.refused)});
  all.push_back({"store_decoded", "Snapshots decoded from the store.", number(reading.decoded)});
  all.push_back({"store_from_decoded", "Found decoded already.", number(reading.from_decoded)});
  all.push_back({"store_decoded_bytes", "Bytes kept decoded.", number(reading.decoded_bytes)});
  all.push_back(
      {"store_damaged_models", "Models that are damaged.", number(reading.damaged_models)});
  all.push_back({"store_substituted", "Answered as recorded, since latents are damaged.",
                 number(reading.substituted)});
  all.push_back({"store_lost_frames", "Damaged before this start.", number(store.lost_frames)});
  return all;
}

std::vector<Figure> all_figures(RpcContext& context,
                                const memory::MemoryService::Counters& counters) {
  std::vector<Figure> all = figures(counters);
  const auto number = [](auto value) { return static_cast<double>(value); };
  all.push_back({"subscribers", "Subscriptions.", number(context.hub.size())});
  all.push_back({"connections_cut", "That opened too many streams which came to no end.",
                 number(ConnectionGuard::of_process()->cut())});
  if (context.redactor) {
    const ltm::RedactionCounters answers = context.redactor->counters();
    all.push_back(
        {"answers_redacted", "Images of answers that were redacted.", number(answers.redacted)});
    all.push_back({"answers_withheld",
                   "Snapshots left out of answers, since nothing could say what to redact.",
                   number(answers.dropped)});
  }
  if (const auto* skilled = context.started_skills ? context.started_skills() : nullptr) {
    const skills::SkillCounters did = skilled->counters();
    all.push_back({"skill_requests", "That asked for a skill.", number(did.requests)});
    all.push_back({"skill_refused", "Requests that were refused.", number(did.refused)});
    all.push_back({"skill_waiting", "Requests that wait now.", number(did.waiting)});
    all.push_back({"skill_started", "Executions that started.", number(did.started)});
    all.push_back({"skill_running", "Executions that run now.", number(did.running)});
    all.push_back({"skill_succeeded", "Executions that succeeded.", number(did.succeeded)});
    all.push_back({"skill_failed", "Executions that failed.", number(did.failed)});
    all.push_back({"skill_stopped", "Executions that were stopped.", number(did.stopped)});
    all.push_back(
        {"skill_lost", "Executions whose provider or memory went away.", number(did.lost)});
  }
  if (!context.sharing) return all;
  const PoolCounters pool = context.sharing->pool().counters();
  all.push_back({"shared_clients", "That share memory with the server.", number(pool.clients)});
  all.push_back({"shared_bytes", "Of all shared memory.", number(pool.slab_bytes)});
  all.push_back({"shared_blocks", "Blocks that somebody has.", number(pool.blocks)});
  all.push_back({"shared_reads", "Blocks that readers have.", number(pool.shares)});
  all.push_back({"shared_exhausted", "Times that there was no room.", number(pool.exhausted)});
  return all;
}

}  // namespace

std::string figures_json(RpcContext& context, const Identity& who) {
  const memory::MemoryService::Counters counters = context.service.counters();
  nlohmann::ordered_json json;
  for (const Figure& figure : all_figures(context, counters))
    json[figure.name] = static_cast<uint64_t>(figure.value);
  if (!counters.last_store_failure.empty() && who.may_read_all(ltm::MemoryId()))
    json["last_store_failure"] = counters.last_store_failure;
  return json.dump();
}

std::string metrics_text(RpcContext& context) {
  for (const Figure& figure : all_figures(context, context.service.counters()))
    context.metrics.registry.gauge("engram_" + figure.name, figure.help).set(figure.value);
  return context.metrics.registry.to_text();
}

}  // namespace engram::server
