// SPDX-License-Identifier: Apache-2.0
#include "training/night/consolidate.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "encoders/load_model.h"
#include "ltm/core/local_time.h"
#include "ltm/core/log.h"
#include "ltm/recall/index_store.h"
#include "ltm/store/checkpoint_file.h"
#include "ltm/store/night_lock.h"
#include "ltm/store/store_reader.h"
#include "training/fit/matching.h"
#include "training/night/choose_form.h"
#include "training/night/consolidate_entity.h"
#include "training/night/entity_work.h"
#include "training/night/expected_encoding.h"
#include "training/night/plan_entity.h"
#include "training/night/record_night.h"
#include "training/night/time_shares.h"

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

/// The time that the entities get of a job that ends at a moment.
class TimeTable {
 public:
  /// All arguments must outlive this object.
  TimeTable(const ConsolidateOptions& options, std::vector<EntityJob>& jobs)
      : options_(options), jobs_(jobs), order_(jobs.size()) {
    std::iota(order_.begin(), order_.end(), size_t{0});
  }

  /// Chooses forms and measures the time of encoding if the job ends at a moment. Then those that
  /// take little time come first.
  Status measure() {
    if (!options_.job.until) return {};
    for (EntityJob& job : jobs_) {
      if (job.planned.is_skipped() || is_over()) continue;
      ENGRAM_ASSIGN_OR_RETURN(job.form, choose_form(job.work, job.planned));
      ENGRAM_ASSIGN_OR_RETURN(job.encoding, measure_encoding(job.work, job.planned, *job.form));
    }
    std::ranges::stable_sort(order_, {}, [&](size_t i) { return jobs_[i].encoding.reserved; });
    return {};
  }

  /// Entities in the order of work.
  [[nodiscard]] const std::vector<size_t>& order() const { return order_; }

  /// The time of the entity that is worked on `at`-th; nothing if the time is over. Its form is
  /// changed to what the time allows.
  Result<std::optional<Allotment>> next(size_t at) {
    EntityJob& job = jobs_[order_[at]];
    if (job.planned.is_skipped()) return std::optional(Allotment{});
    if (is_over() || (options_.job.until && !job.form)) return std::optional<Allotment>();
    if (options_.job.until) return until(*options_.job.until, at);
    double weights = 0;
    for (const TimeNeed& need : needs_from(at)) weights += need.weight;
    ENGRAM_ASSIGN_OR_RETURN(
        const Duration budget,
        duration_from_seconds(to_seconds(options_.train.budget) * job.planned.weight() / weights));
    return std::optional(Allotment{.budget = budget});
  }

 private:
  /// Of the entities that are worked on.
  [[nodiscard]] std::vector<TimeNeed> needs_from(size_t at) const {
    std::vector<TimeNeed> needs;
    for (size_t i = at; i < order_.size(); ++i) {
      const EntityJob& job = jobs_[order_[i]];
      if (!job.planned.is_skipped()) needs.push_back({job.encoding.reserved, job.planned.weight()});
    }
    return needs;
  }

  [[nodiscard]] bool is_over() const {
    return options_.job.until && system_now() >= *options_.job.until;
  }

  Result<std::optional<Allotment>> until(Time end, size_t at) {
    EntityJob& job = jobs_[order_[at]];
    const Time now = system_now();
    ENGRAM_ASSIGN_OR_RETURN(const TimeShare share,
                            fit_form(first_share(needs_from(at), to_seconds(end - now)), job));
    ENGRAM_ASSIGN_OR_RETURN(const Duration budget, duration_from_seconds(share.training));
    ENGRAM_ASSIGN_OR_RETURN(const Duration all, duration_from_seconds(share.total()));
    log::info("{}: {:.0f} s to train, {:.0f} s to encode, until {}", job.work.entity.to_string(),
              share.training, share.encoding, to_local_string(now + all));
    // A budget must be positive, and training always makes a model, if not a good one.
    return std::optional(Allotment{.budget = std::max(budget, Duration(1)),
                                   .end = now + budget,
                                   .encoded_end = now + all - kPublishing,
                                   .seconds_per_snapshot = job.encoding.per_snapshot});
  }

  /// Changes a form to what the time allows, and divides the time between training and encoding.
  Result<TimeShare> fit_form(TimeShare share, EntityJob& job) const {
    if (options_.reuses_models) return TimeShare{0, share.total(), share.is_short};
    ChosenForm& form = *job.form;
    if (share.is_short && form.may_become_video()) {
      form = form.as_video_alone();
      form.notes.push_back(
          fmt::format("no time to train networks: with them encoding may take {:.0f} s",
                      job.encoding.reserved));
      ENGRAM_ASSIGN_OR_RETURN(job.encoding, measure_encoding(job.work, job.planned, form));
      share.encoding = std::min(share.encoding, job.encoding.reserved);
    }
    if (form.is_video_alone() && (share.is_short || job.planned.has_images_alone())) {
      // Nothing is trained, so all the time is for a search with more effort, or less.
      share = {0, share.total(), share.is_short};
      fit_videos(share, job);
    } else if (share.is_short) {
      share.training = kShortTraining * share.encoding;
      share.encoding -= share.training;
    }
    return share;
  }

  static void fit_videos(const TimeShare& share, EntityJob& job) {
    const double times = std::max(share.encoding / std::max(job.encoding.reserved, 1.0), kMinTimes);
    if (times < 1 || times > kSpareTimes) job.encoding.per_snapshot *= job.form->spend(times);
    const EntityPlan& plan = job.planned.plan;
    uint64_t& bytes = job.form->train.memory_bytes;
    if (share.is_short) bytes = std::min(bytes, kShortMeasured * plan.plain_bytes / plan.snapshots);
  }

  /// Writing and publishing at the end.
  static constexpr Duration kPublishing = std::chrono::seconds(2);
  /// More time than this many times the usual goes into better videos.
  static constexpr double kSpareTimes = 1.5;
  /// The quickest effort takes more than this share of the usual time.
  static constexpr double kMinTimes = 0.05;
  /// Where the time is short, predictions are measured on so many snapshots.
  static constexpr uint64_t kShortMeasured = 32;
  /// Share of a short time that training gets where there is no form without networks.
  static constexpr double kShortTraining = 0.25;

  const ConsolidateOptions& options_;
  std::vector<EntityJob>& jobs_;
  std::vector<size_t> order_;
};

/// Consolidates an entity. Another process of the job may have replaced a segment that has more
/// entities than its own. Then the entity is planned and read again as the store is now, and
/// training goes on from its checkpoint.
Result<EntityReport> consolidate_job(const std::filesystem::path& store, const EntityJob& job,
                                     const Allotment& allotment) {
  constexpr int kTries = 3;
  auto done = consolidate_entity(job.work, job.planned, job.form, allotment);
  for (int tries = 1; tries < kTries && done.status().code() == StatusCode::kUnavailable; ++tries) {
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(store));
    if (reader->manifest().generation == job.work.reader.manifest().generation) break;
    log::info("{}: the store was changed meanwhile, so it is read again",
              job.work.entity.to_string());
    const EntityWork work{*reader, job.work.entity, job.work.options, job.work.pace, *job.costs};
    ENGRAM_ASSIGN_OR_RETURN(const PlannedEntity planned, plan_entity(work));
    done = consolidate_entity(work, planned, job.form, allotment);
  }
  return done;
}

/// Codes the images of the entities of a job, so that moments like others are found, and then
/// calculates what all their snapshots are worth, for which codes are needed. Both come last,
/// because what belongs to latents stays when the recorded form goes.
Status look_back(const std::filesystem::path& store, const Jobs& jobs,
                 const ConsolidateOptions& options, JobPace& pace, ConsolidateReport& report) {
  std::set<ltm::MemoryId> entities;
  for (const EntityJob& job : jobs.entities) entities.insert(job.work.entity);
  ltm::CodesOptions codes;
  codes.matches = [&entities](const ltm::MemoryId& id) { return entities.contains(id); };
  codes.is_over = [&options, &pace] {
    return (options.job.until && system_now() >= *options.job.until) || !pace.pause().ok();
  };
  ENGRAM_ASSIGN_OR_RETURN(report.codes, ltm::make_codes(store, encoders::load_model, codes,
                                                        pace.progress(), pace.stop()));
  ENGRAM_ASSIGN_OR_RETURN(report.saliency, ltm::make_saliency(store, encoders::load_model,
                                                              {codes.matches, codes.is_over},
                                                              pace.progress(), pace.stop()));
  return {};
}

/// What the night published has no index of places and links yet. Questions are answered without
/// one, only later, so a night does not fail for it.
void index_places(const std::filesystem::path& store, const ConsolidateOptions& options,
                  JobPace& pace) {
  const auto indexed = ltm::index_store(
      store, encoders::load_model,
      [&options, &pace] {
        return (options.job.until && system_now() >= *options.job.until) || !pace.pause().ok();
      },
      {}, pace.stop());
  if (!indexed.ok() && indexed.status().code() != StatusCode::kCancelled)
    log::warning("store '{}': places and links have no index: {}", store.string(),
                 indexed.status().message());
}

Status work_through(const std::filesystem::path& store, const ConsolidateOptions& options,
                    Jobs& jobs, JobPace& pace, ConsolidateReport& report) {
  TimeTable time(options, jobs.entities);
  ENGRAM_RETURN_IF_ERROR(time.measure());
  report.entities.resize(jobs.entities.size());
  for (size_t at = 0; at < time.order().size(); ++at) {
    ENGRAM_ASSIGN_OR_RETURN(const auto allotment, time.next(at));
    const EntityJob& job = jobs.entities[time.order()[at]];
    EntityReport& one = report.entities[time.order()[at]];
    if (!allotment) {
      one = skip_entity(job.work, job.planned, nothing_encoded());
    } else {
      ENGRAM_ASSIGN_OR_RETURN(one, consolidate_job(store, job, *allotment));
    }
    one.expected_encoding_seconds = job.encoding.seconds;
    one.costs = *job.costs;
  }
  ENGRAM_RETURN_IF_ERROR(look_back(store, jobs, options, pace, report));
  index_places(store, options, pace);
  return {};
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
  ENGRAM_ASSIGN_OR_RETURN(const auto lock, ltm::NightLock::of_learning(store));
  JobPace pace(busy.get(), progress, stop, options.job.until);
  ConsolidateReport report;
  report.began = options.job.began.value_or(system_now());
  ENGRAM_ASSIGN_OR_RETURN(Jobs jobs, Jobs::make(store, options, pace));
  ENGRAM_ASSIGN_OR_RETURN(
      ltm::NightAccount account,
      ltm::NightAccount::open(store, ltm::NightWork::kConsolidate, report.began));
  if (const Status removed = ltm::remove_checkpoints_of_others(store, jobs.reader->entities());
      !removed.ok())
    log::warning("a stale checkpoint stays: {}", removed.message());
  if (plan) plan(jobs.plan);
  const Status done = work_through(store, options, jobs, pace, report);
  record_night(std::move(account), jobs.plan, report, done);
  ENGRAM_RETURN_IF_ERROR(done);
  return report;
}

}  // namespace engram::training
