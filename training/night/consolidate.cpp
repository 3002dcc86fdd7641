// SPDX-License-Identifier: Apache-2.0
#include "training/night/consolidate.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "ltm/core/local_time.h"
#include "ltm/core/log.h"
#include "ltm/store/checkpoint_file.h"
#include "ltm/store/store_reader.h"
#include "training/fit/matching.h"
#include "training/night/entity_job.h"

namespace engram::training {

namespace {

/// The work on a store, entity by entity.
struct Jobs {
  std::unique_ptr<ltm::StoreReader> reader;
  std::vector<EntityJob> entities;
  ConsolidatePlan plan;  ///< One for each.

  /// All but the result outlive it.
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
      EntityJob& job = jobs.entities.emplace_back(*jobs.reader, entity, options, pace);
      ENGRAM_RETURN_IF_ERROR(job.plan());
      total_weight += job.weight();
    }
    for (const EntityJob& job : jobs.entities) {
      jobs.plan.entities.push_back(job.planned());
      if (total_weight > 0) jobs.plan.entities.back().budget_share = job.weight() / total_weight;
    }
    return jobs;
  }
};

/// Divides the time of a job among its entities by their weights.
class TimeShares {
 public:
  /// Both outlive it.
  TimeShares(const ConsolidateOptions& options, std::vector<EntityJob>& jobs)
      : options_(options), jobs_(jobs), reserved_(jobs.size(), 0.0) {
    for (const EntityJob& job : jobs) weights_.push_back(job.weight());
  }

  /// Measures what encoding will take, where everything ends at a moment.
  Status measure() {
    if (!options_.job.until) return {};
    for (size_t i = 0; i < jobs_.size(); ++i) {
      ENGRAM_ASSIGN_OR_RETURN(reserved_[i], jobs_[i].measure_encoding());
    }
    return {};
  }

  /// Skips the entity where no time is left for it.
  Result<Allotment> next(size_t i) {
    if (weights_[i] == 0) return Allotment{};
    if (options_.job.until) return until(*options_.job.until, i);
    ENGRAM_ASSIGN_OR_RETURN(
        const Duration budget,
        duration_from_seconds(to_seconds(options_.train.budget) * weights_[i] / sum(weights_, 0)));
    return Allotment{budget, {}, {}};
  }

 private:
  static double sum(const std::vector<double>& values, size_t first) {
    return std::accumulate(values.begin() + static_cast<ptrdiff_t>(first), values.end(), 0.0);
  }

  Result<Allotment> until(Time end, size_t i) {
    const Time now = system_now();
    const double left = to_seconds(end - now) - sum(reserved_, i);
    ENGRAM_ASSIGN_OR_RETURN(const Duration budget,
                            duration_from_seconds(left * weights_[i] / sum(weights_, i)));
    ENGRAM_ASSIGN_OR_RETURN(const Duration encoding, duration_from_seconds(reserved_[i]));
    if (budget <= Duration::zero() && !options_.reuses_models) {
      ENGRAM_RETURN_IF_ERROR(jobs_[i].skip_for_want_of_time(
          fmt::format("no time to train until {}: encoding may take {:.0f} s", to_local_string(end),
                      sum(reserved_, i))));
      return Allotment{};
    }
    log::info("{}: trains until {}, leaves {:.0f} s to encode",
              jobs_[i].planned().entity.to_string(), to_local_string(now + budget), reserved_[i]);
    return Allotment{budget, now + budget, now + budget + encoding};
  }

  const ConsolidateOptions& options_;
  std::vector<EntityJob>& jobs_;
  std::vector<double> weights_;
  std::vector<double> reserved_;  ///< For encoding. Unit: s.
};

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
  TimeShares time(options, jobs.entities);
  ENGRAM_RETURN_IF_ERROR(time.measure());
  ConsolidateReport report;
  for (size_t i = 0; i < jobs.entities.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const Allotment allotment, time.next(i));
    ENGRAM_ASSIGN_OR_RETURN(EntityReport one, jobs.entities[i].run(allotment));
    report.entities.push_back(std::move(one));
  }
  return report;
}

}  // namespace engram::training
