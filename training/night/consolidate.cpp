// SPDX-License-Identifier: Apache-2.0
#include "training/night/consolidate.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "ltm/core/local_time.h"
#include "ltm/core/log.h"
#include "ltm/store/checkpoint_file.h"
#include "ltm/store/store_reader.h"
#include "training/fit/matching.h"
#include "training/night/choose_form.h"
#include "training/night/consolidate_entity.h"
#include "training/night/entity_work.h"
#include "training/night/expected_encoding.h"
#include "training/night/plan_entity.h"

namespace engram::training {

namespace {

/// The state of one entity between the steps.
struct EntityJob {
  std::unique_ptr<EntityCosts> costs;
  EntityWork work;  ///< Refers to the costs.
  PlannedEntity planned;
  std::optional<ChosenForm> form;  ///< Set if it was needed to measure encoding.
  ExpectedEncoding encoding;       ///< Zero if it was not measured.
};

/// The work on a store, with one job per entity.
struct Jobs {
  std::unique_ptr<ltm::StoreReader> reader;
  std::vector<EntityJob> entities;
  ConsolidatePlan plan;  ///< One for each.

  /// All arguments must outlive the result.
  static Result<Jobs> make(const std::filesystem::path& store, const ConsolidateOptions& options,
                           JobPace& pace) {
    ENGRAM_RETURN_IF_ERROR(options.validate());
    Jobs jobs;
    ENGRAM_ASSIGN_OR_RETURN(jobs.reader, ltm::StoreReader::open(store));
    ENGRAM_ASSIGN_OR_RETURN(const auto entities, matching_entities(*jobs.reader, options.entities));
    if (entities.empty())
      return not_found("store '{}': none of its {} entities matches", store.string(),
                       jobs.reader->entities().size());
    double total_weight = 0;
    for (const ltm::MemoryId& entity : entities) {
      auto costs = std::make_unique<EntityCosts>();
      EntityWork work{*jobs.reader, entity, options, pace, *costs};
      ENGRAM_ASSIGN_OR_RETURN(PlannedEntity planned, plan_entity(work));
      total_weight += planned.weight();
      jobs.entities.push_back({std::move(costs), std::move(work), std::move(planned), {}, {}});
    }
    for (const EntityJob& job : jobs.entities) {
      EntityPlan& plan = jobs.plan.entities.emplace_back(job.planned.plan);
      if (total_weight > 0) plan.budget_share = job.planned.weight() / total_weight;
    }
    return jobs;
  }
};

/// Chooses forms and measures the time of encoding if the job ends at a moment. The rest of the
/// time is for training.
Status measure_encoding(const ConsolidateOptions& options, std::vector<EntityJob>& jobs) {
  if (!options.job.until) return {};
  for (EntityJob& job : jobs) {
    if (job.planned.is_skipped()) continue;
    ENGRAM_ASSIGN_OR_RETURN(job.form, choose_form(job.work, job.planned));
    ENGRAM_ASSIGN_OR_RETURN(job.encoding, measure_encoding(job.work, job.planned, *job.form));
  }
  return {};
}

/// Divides the time of a job among its entities by their weights.
class TimeShares {
 public:
  /// Both must outlive this object.
  TimeShares(const ConsolidateOptions& options, const std::vector<EntityJob>& jobs)
      : options_(options), jobs_(jobs) {}

  /// Time for the next entity; nothing if none is left.
  Result<std::optional<Allotment>> next(size_t i) const {
    using Time = std::optional<Allotment>;
    const double weight = jobs_[i].planned.weight();
    if (weight == 0) return Time(Allotment{});
    if (options_.job.until) return until(*options_.job.until, i);
    ENGRAM_ASSIGN_OR_RETURN(
        const Duration budget,
        duration_from_seconds(to_seconds(options_.train.budget) * weight / weights_from(0)));
    return Time(Allotment{budget, {}, {}});
  }

  /// Time for encoding all entities from the i-th on. Unit: s.
  [[nodiscard]] double reserved_from(size_t i) const {
    double sum = 0;
    for (; i < jobs_.size(); ++i) sum += jobs_[i].encoding.reserved;
    return sum;
  }

 private:
  [[nodiscard]] double weights_from(size_t i) const {
    double sum = 0;
    for (; i < jobs_.size(); ++i) sum += jobs_[i].planned.weight();
    return sum;
  }

  Result<std::optional<Allotment>> until(Time end, size_t i) const {
    const EntityJob& job = jobs_[i];
    const Time now = system_now();
    // The division is repeated for every entity, so time that one saves or loses is shared by the
    // rest.
    const double left = to_seconds(end - now) - reserved_from(i);
    ENGRAM_ASSIGN_OR_RETURN(const Duration budget,
                            duration_from_seconds(left * job.planned.weight() / weights_from(i)));
    ENGRAM_ASSIGN_OR_RETURN(const Duration encoding, duration_from_seconds(job.encoding.reserved));
    if (budget <= Duration::zero() && !options_.reuses_models) return std::optional<Allotment>();
    log::info("{}: trains until {}, leaves {:.0f} s to encode", job.work.entity.to_string(),
              to_local_string(now + budget), job.encoding.reserved);
    return std::optional(Allotment{budget, now + budget, now + budget + encoding});
  }

  const ConsolidateOptions& options_;
  const std::vector<EntityJob>& jobs_;
};

Skipped no_time(const ConsolidateOptions& options, const TimeShares& time, size_t i) {
  return {fmt::format("no time to train until {}: encoding may take {:.0f} s",
                      to_local_string(*options.job.until), time.reserved_from(i)),
          true};
}

}  // namespace

Result<ConsolidatePlan> plan_consolidation(const std::filesystem::path& store,
                                           const ConsolidateOptions& options,
                                           const std::stop_token& stop) {
  const ProgressSink no_progress;
  JobPace pace(nullptr, no_progress, stop);
  ENGRAM_ASSIGN_OR_RETURN(const Jobs jobs, Jobs::make(store, options, pace));
  return jobs.plan;
}

Result<ConsolidateReport> consolidate(const std::filesystem::path& store,
                                      const ConsolidateOptions& options,
                                      const ProgressSink& progress, const std::stop_token& stop,
                                      const PlanSink& plan) {
  std::unique_ptr<RobotBusy> busy;
  if (const auto& yield = options.job.yield; !yield.file.empty() || !yield.command.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(busy, RobotBusy::create(yield));
  }
  JobPace pace(busy.get(), progress, stop, options.job.until);
  ENGRAM_ASSIGN_OR_RETURN(Jobs jobs, Jobs::make(store, options, pace));
  if (const Status removed = ltm::remove_checkpoints_of_others(store, jobs.reader->entities());
      !removed.ok())
    log::warning("a stale checkpoint stays: {}", removed.message());
  if (plan) plan(jobs.plan);
  ENGRAM_RETURN_IF_ERROR(measure_encoding(options, jobs.entities));
  const TimeShares time(options, jobs.entities);
  ConsolidateReport report;
  for (size_t i = 0; i < jobs.entities.size(); ++i) {
    const EntityJob& job = jobs.entities[i];
    ENGRAM_ASSIGN_OR_RETURN(const auto allotment, time.next(i));
    if (!allotment) {
      report.entities.push_back(skip_entity(job.work, job.planned, no_time(options, time, i)));
    } else {
      ENGRAM_ASSIGN_OR_RETURN(EntityReport one,
                              consolidate_entity(job.work, job.planned, job.form, *allotment));
      report.entities.push_back(std::move(one));
    }
    report.entities.back().expected_encoding_seconds = job.encoding.seconds;
    report.entities.back().costs = *job.costs;
  }
  return report;
}

}  // namespace engram::training
