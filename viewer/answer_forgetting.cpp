// SPDX-License-Identifier: Apache-2.0
// What forgetting would do. It is planned, and nothing here could carry a plan out: it has no tools
// for it.
#include <algorithm>

#include "reports/plain/forget_job.h"
#include "reports/plain/forget_text.h"
#include "viewer/forget_form.h"
#include "viewer/view_answers.h"

namespace engram::viewer {

namespace {

using reports::Json;
using Counts = std::vector<uint32_t>;

Counts count_times(const TimeSet& set, const ltm::TimeBins& bins) {
  const std::vector<Time> times(set.begin(), set.end());
  ltm::EntityTimes one;
  one.add(times, false, false);
  Counts counts;
  for (const ltm::FormCounts& bin : one.count_in(bins)) counts.push_back(bin.recorded);
  return counts;
}

/// What a plan does to an entity over time.
struct ForgetLane {
  Counts stays;
  Counts gone;
  Counts fades;

  static ForgetLane of(const ltm::EntityForgetPlan& plan, const ltm::EntityTimes& times,
                       const ltm::TimeBins& bins) {
    ForgetLane lane{{}, count_times(plan.gone, bins), Counts(bins.count())};
    for (const ltm::FadingSnapshots& part : plan.fading) {
      const Counts some = count_times(part.times, bins);
      for (size_t i = 0; i < some.size(); ++i) lane.fades[i] += some[i];
    }
    // The store may have grown since the plan was made, or lost something.
    for (const ltm::FormCounts& bin : times.count_in(bins)) {
      const size_t i = lane.stays.size();
      const uint32_t all = bin.recorded + bin.latent + bin.augmented;
      lane.stays.push_back(all - std::min(all, lane.gone[i] + lane.fades[i]));
    }
    return lane;
  }
};

Json lane_json(ForgetLane lane) {
  return {{"stays", std::move(lane.stays)},
          {"fades", std::move(lane.fades)},
          {"gone", std::move(lane.gone)}};
}

/// Entities of a plan, those that lose most bytes in front; of those that lose nothing by name.
std::vector<const std::pair<const ltm::MemoryId, ltm::EntityForgetPlan>*> ordered(
    const ltm::ForgetPlan& plan) {
  std::vector<const std::pair<const ltm::MemoryId, ltm::EntityForgetPlan>*> entities;
  for (const auto& entity : plan.entities) entities.push_back(&entity);
  std::ranges::stable_sort(entities, std::greater<>(), [](const auto* entity) {
    const ltm::EntityForgetPlan& one = entity->second;
    return std::pair(!one.gone.empty() || !one.fading.empty(), one.freed_bytes + one.faded_bytes);
  });
  return entities;
}

/// From the first snapshot of the store to the last one.
Result<ltm::TimeBins> bins_of_life(ViewedMemory& viewed, const StoreView& view,
                                   const ltm::ForgetPlan& plan, size_t count) {
  std::optional<Time> first, last;
  for (const auto& [id, entity] : plan.entities) {
    if (!view.reader.has(id)) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto times, viewed.times(view, id));
    if (times->all.empty()) continue;
    first = std::min(first.value_or(times->all.front()), times->all.front());
    last = std::max(last.value_or(times->all.back()), times->all.back());
  }
  const Time begin = first.value_or(Time{});
  return ltm::TimeBins::create(begin, last.value_or(begin) + Duration(1), count);
}

ViewAnswer plan_answer(ViewedMemory& viewed, const std::string& config, const ltm::ForgetPlan& plan,
                       size_t bins, size_t max_lanes) {
  Json json;
  ENGRAM_RETURN_IF_ERROR(viewed.with_store([&](const StoreView& view) -> Status {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::TimeBins life, bins_of_life(viewed, view, plan, bins));
    Json entities = Json::array();
    uint64_t stay_elsewhere = 0;
    for (const auto* entity : ordered(plan)) {
      const auto& [id, one] = *entity;
      const bool has_lane = entities.size() < max_lanes;
      if (!has_lane && one.gone.empty() && one.fading.empty()) {
        stay_elsewhere += one.stays;
        continue;
      }
      Json told = reports::planned_entity_json(id, one);
      if (has_lane && view.reader.has(id)) {
        ENGRAM_ASSIGN_OR_RETURN(const auto times, viewed.times(view, id));
        told["lane"] = lane_json(ForgetLane::of(one, *times, life));
      }
      entities.push_back(std::move(told));
    }
    json = {{"config", config},
            {"from", time_text(life.begin(0))},
            {"to", time_text(life.begin(life.count()))},
            {"bins", bins},
            {"plan", reports::plan_sums_json(plan)},
            {"left_out", plan.entities.size() - entities.size()},
            {"left_out_stays", stay_elsewhere},
            {"entities", std::move(entities)}};
    return {};
  }));
  return bounded_json(json);
}

}  // namespace

ViewAnswer answer_forgetting(ViewedMemory& viewed, const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const LongQuestion question, long_question(target));
  const std::string name = "forgetting " + question.page;
  if (question.is_called_off) {
    viewed.long_questions().call_off(name);
    return json_response({{"called_off", true}});
  }
  ENGRAM_ASSIGN_OR_RETURN(const int64_t bins, target.integer("bins", 1, 2000, 240));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t lanes, target.integer("lanes", 0, 400, 100));
  ENGRAM_ASSIGN_OR_RETURN(ForgetPolicyText policy, read_forget_policy(target));
  if (!viewed.is_store())
    return failed_precondition(
        "'{}': a server does not tell what its stores would forget; 'engram view' of a store, or "
        "'engram forget --dry-run' beside it, does",
        viewed.options().name);
  ENGRAM_ASSIGN_OR_RETURN(const auto running, viewed.long_questions().begin(name, question.budget));
  // Without tools, and with plan() alone: this cannot change anything.
  const reports::ForgetJob job{.store = viewed.options().store.string(),
                               .targets = {},
                               .options = std::move(policy.options),
                               .loader = viewed.options().loader,
                               .progress = {},
                               .stop = running->stop(),
                               .tools = {},
                               .erases = false};
  const auto plan = job.plan();
  if (!plan.ok()) return running->explained(plan.status(), "the plan");
  return plan_answer(viewed, policy.config, *plan, static_cast<size_t>(bins),
                     static_cast<size_t>(lanes));
}

}  // namespace engram::viewer
