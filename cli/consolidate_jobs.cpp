// SPDX-License-Identifier: Apache-2.0
#include "cli/consolidate_jobs.h"

#include <algorithm>
#include <thread>

#include "cli/child_process.h"
#include "cli/interrupt.h"
#include "cli/shared_progress.h"
#include "ltm/core/log.h"
#include "reports/consolidate_text.h"
#include "training/night/parallel_speed.h"

namespace engram::cli {

namespace {

/// The entities that will be trained, with their shares of the time.
struct Work {
  std::vector<ltm::MemoryId> entities;
  std::vector<double> shares;
};

Work work_of(const training::ConsolidatePlan& plan) {
  Work work;
  for (const training::EntityPlan& entity : plan.entities) {
    if (!entity.skipped_reason.empty() || !(entity.budget_share > 0)) continue;
    work.entities.push_back(entity.entity);
    work.shares.push_back(entity.budget_share);
  }
  return work;
}

std::vector<std::string> child_arguments(const std::vector<ltm::MemoryId>& entities,
                                         const std::vector<std::string>& arguments, bool is_json,
                                         bool has_progress) {
  std::vector<std::string> all{"/proc/self/exe", "consolidate"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  for (const ltm::MemoryId& entity : entities) all.push_back("--entity=" + entity.to_string());
  for (const char* more : {"--threads=1", "--jobs=1", kPartOption}) all.emplace_back(more);
  all.emplace_back(has_progress ? "--progress=json" : "--progress=none");
  if (is_json) all.emplace_back("--json");
  return all;
}

/// Each part counts its own entities; weights are learned from all reads by each.
void add_saliency(const Json& part, Json& all) {
  const Json own = part.is_object() ? part.value("saliency", Json::object()) : Json::object();
  for (const char* sum : {"entities", "snapshots"})
    all[sum] = all.value(sum, uint64_t{0}) + own.value(sum, uint64_t{0});
  all["learned_from"] =
      std::max(all.value("learned_from", uint64_t{0}), own.value("learned_from", uint64_t{0}));
}

/// Joins the reports of all parts, with entities in the order of the plan.
Json united_report(const training::ConsolidatePlan& plan,
                   const std::vector<ChildProcess>& children) {
  Json all{{"plan", reports::plan_json(plan)},
           {"entities", Json::array()},
           {"dropped", Json::array()},
           {"codes", Json::array()},
           {"saliency", {{"entities", 0}, {"snapshots", 0}, {"learned_from", 0}}}};
  for (const ChildProcess& child : children) {
    const Json part = Json::parse(child.output, nullptr, false);
    for (const char* list : {"entities", "dropped", "codes"}) {
      if (!part.is_object() || !part.contains(list)) continue;
      for (const Json& one : part.at(list)) all[list].push_back(one);
    }
    add_saliency(part, all["saliency"]);
  }
  const auto place_of = [&](const Json& one) {
    const auto is_it = [&](const auto& entity) {
      return entity.entity.to_string() == one.value("entity", "");
    };
    return std::ranges::find_if(plan.entities, is_it) - plan.entities.begin();
  };
  for (const char* list : {"entities", "dropped", "codes"})
    std::sort(all[list].begin(), all[list].end(),
              [&](const Json& a, const Json& b) { return place_of(a) < place_of(b); });
  return all;
}

}  // namespace

std::vector<std::vector<ltm::MemoryId>> split_jobs(const training::ConsolidatePlan& plan) {
  const Work work = work_of(plan);
  if (work.entities.size() < 2) return {};
  std::vector<std::vector<ltm::MemoryId>> groups;
  for (const auto& group : training::split_in_two(work.shares)) {
    auto& entities = groups.emplace_back();
    for (const size_t i : group) entities.push_back(work.entities[i]);
  }
  // Skipped entities take no time but must appear in the report.
  for (const training::EntityPlan& entity : plan.entities)
    if (std::ranges::find(work.entities, entity.entity) == work.entities.end())
      groups.front().push_back(entity.entity);
  return groups;
}

std::vector<std::vector<ltm::MemoryId>> split_by_measurement(
    const training::ConsolidatePlan& plan) {
  const Work work = work_of(plan);
  if (work.entities.size() < 2 || std::thread::hardware_concurrency() < 2) return {};
  const training::ParallelSpeed speed = training::measure_parallel_speed();
  const bool are_two = training::two_are_quicker(work.shares, speed);
  log::info("{:.0f} steps per second with two threads, {:.0f} in two processes: {}",
            speed.one_of_two, speed.two_of_one,
            are_two ? "two processes" : "one process, for these entities");
  return are_two ? split_jobs(plan) : std::vector<std::vector<ltm::MemoryId>>{};
}

ExitCode run_jobs(const training::ConsolidatePlan& plan,
                  const std::vector<std::vector<ltm::MemoryId>>& groups,
                  const std::vector<std::string>& arguments, ProgressForm form, bool is_json) {
  ProgressLine line(form);
  SharedProgress progress(groups.size(), line);
  std::vector<ChildProcess> children;
  for (size_t i = 0; i < groups.size(); ++i)
    children.push_back({child_arguments(groups[i], arguments, is_json, form != ProgressForm::kNone),
                        [&progress, i, form](const std::string& text) {
                          progress.tell(i, text, form == ProgressForm::kJson);
                        }});
  if (!is_json) {
    reports::print_plan(plan);
    std::fflush(stdout);
  }
  const Status run = run_children(children, interrupt_token());
  line.finish();
  if (!run.ok()) return fail(run);
  ExitCode worst = ExitCode::kDone;
  for (const ChildProcess& child : children) {
    if (!is_json) fmt::print("{}", child.output);
    if (child.exit_code != 0) worst = ExitCode::kFailed;
  }
  if (is_json) print_json(united_report(plan, children));
  return worst;
}

}  // namespace engram::cli
