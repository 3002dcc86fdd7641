// SPDX-License-Identifier: Apache-2.0
#include "training/measure/predicted_moment.h"

#include <algorithm>
#include <cmath>

#include "ltm/core/sequences.h"
#include "training/measure/quality_sums.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {

namespace {

using ltm::MemoryId;
using ltm::Recall;
using ltm::SnapshotResult;

/// Number of last snapshots whose median interval is the step.
constexpr int64_t kStepTimes = 1000;

Result<std::vector<Time>> times_of(Recall& recall, const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, recall.store().index(entity));
  std::vector<Time> times;
  for (const ltm::SnapshotEntry& entry : *index) times.push_back(entry.time);
  return times;
}

/// The snapshots that a selector finds, or their times alone.
Result<std::vector<SnapshotResult>> snapshots_of(const PredictionSource& source,
                                                 const MemoryId& entity,
                                                 const ltm::Selector& selector,
                                                 bool is_ids_only = false) {
  ltm::Query query = ltm::Query::of_entity(entity, selector);
  if (is_ids_only) {
    ENGRAM_ASSIGN_OR_RETURN(query, ltm::Query::create(query.memories(), true));
  }
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult answer, source.query(query));
  const ltm::EntityResult* found = answer.find_entity(entity);
  return found == nullptr ? std::vector<SnapshotResult>() : found->snapshots;
}

/// The snapshot closest to `when`, later than the one from which the prediction was made.
Result<std::optional<SnapshotResult>> actual_of(const PredictionSource& source,
                                                const MemoryId& entity, Time when, Time from,
                                                Duration step) {
  // One nanosecond less than half a step, so that a snapshot in the middle of two moments belongs
  // to neither.
  const Duration tolerance = std::max(Duration(0), (step - Duration(1)) / 2);
  ENGRAM_ASSIGN_OR_RETURN(auto found,
                          snapshots_of(source, entity, ltm::select::Nearest{when, tolerance}));
  if (found.empty() || found.front().time <= from ||
      found.front().source == ltm::Source::kPredicted)
    return std::optional<SnapshotResult>();
  return std::optional(std::move(found.front()));
}

/// Compares the first instances, but for the members that count in no error; nothing if they have
/// different layouts.
std::optional<ltm::MeasuredError> error_of(const SnapshotResult& actual,
                                           const SnapshotResult& other,
                                           const std::vector<std::string>& uncounted) {
  if (actual.instances.empty() || other.instances.empty()) return std::nullopt;
  const auto error =
      compare_prediction(actual.instances.front().data, other.instances.front().data, uncounted);
  return error.ok() ? std::optional(*error) : std::nullopt;
}

/// Paths of the members of a first instance that count in no error.
std::vector<std::string> uncounted_in(const SnapshotResult& predicted) {
  std::vector<std::string> paths;
  if (predicted.instances.empty()) return paths;
  for (const ltm::MemberPrediction& member : predicted.instances.front().members)
    if (!member.is_counted) paths.push_back(member.path);
  return paths;
}

bool is_anything_moving(const SnapshotResult& predicted) {
  return std::ranges::any_of(predicted.instances, [](const ltm::InstanceResult& instance) {
    return std::ranges::any_of(instance.members, &ltm::MemberPrediction::is_moving);
  });
}

ltm::ErrorEstimate told_by(const SnapshotResult& predicted) {
  if (predicted.instances.empty()) return {};
  const ltm::InstanceResult& first = predicted.instances.front();
  return {first.error.value_or(ltm::MeasuredError{}), first.bound.value_or(ltm::MeasuredError{})};
}

}  // namespace

std::optional<bool> PredictedHorizon::is_within() const {
  if (!error) return std::nullopt;
  const ltm::MeasuredError bound = told_by(predicted).bound;
  std::optional<bool> is_within;
  const auto add = [&](double real, double max) {
    if (std::isnan(real) || std::isnan(max)) return;
    is_within = is_within.value_or(true) && real <= max;
  };
  add(error->image_mse, bound.image_mse);
  add(error->number_mse, bound.number_mse);
  return is_within;
}

PredictionSource source_of(Recall& recall, const MemoryId& entity) {
  return {[&recall, entity](const ltm::PredictionRequest& request) {
            return recall.predict(entity, request, {});
          },
          [&recall](const ltm::Query& query) { return recall.query(query); }};
}

Result<Duration> step_of(Recall& recall, const MemoryId& entity, const Recall::Engine& engine) {
  if (engine.predictor->step() > Duration(0)) return engine.predictor->step();
  return step_of(source_of(recall, entity), entity);
}

Result<Duration> step_of(const PredictionSource& source, const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const auto newest,
                          snapshots_of(source, entity, ltm::select::Latest{kStepTimes}, true));
  std::vector<Time> times;
  for (const SnapshotResult& one : newest) times.push_back(one.time);
  return median_step(times);
}

Result<Time> last_known_from(const PredictionSource& source, const MemoryId& entity,
                             Duration ahead) {
  const auto time_at = [&](const ltm::Selector& selector) -> Result<std::optional<Time>> {
    ENGRAM_ASSIGN_OR_RETURN(const auto found, snapshots_of(source, entity, selector, true));
    return found.empty() ? std::nullopt : std::optional(found.front().time);
  };
  ENGRAM_ASSIGN_OR_RETURN(const auto last, time_at(ltm::select::Latest{}));
  std::optional<Time> from;
  if (last && to_ns(*last) >= INT64_MIN + ahead.count()) {
    ENGRAM_ASSIGN_OR_RETURN(from, time_at(ltm::select::Before{*last - ahead, true}));
  }
  if (from) return *from;
  return not_found("entity '{}': has no two snapshots {} apart", entity.to_string(),
                   engram::to_string(ahead));
}

Result<PredictedMoment> predict_moment(const PredictionSource& source, const MemoryId& entity,
                                       const ltm::PredictionRequest& request, Duration step) {
  ENGRAM_ASSIGN_OR_RETURN(auto predicted, source.predict(request));
  const Time from = predicted.front().time - predicted.front().horizon;
  ltm::PredictionRequest copying = request;
  copying.engine = ltm::kCopyLast;
  copying.plan.reset();
  ENGRAM_ASSIGN_OR_RETURN(auto copied, source.predict(copying));
  if (copied.front().time != predicted.front().time) {
    copying.from = from;  // A snapshot has come since.
    ENGRAM_ASSIGN_OR_RETURN(copied, source.predict(copying));
  }
  ENGRAM_ASSIGN_OR_RETURN(auto last, snapshots_of(source, entity, ltm::select::At{from}));
  if (last.empty())
    return not_found("'{}': was predicted from and is gone", entity.at(from).to_string());
  PredictedMoment moment{std::move(last.front()), {}};
  for (size_t i = 0; i < predicted.size(); ++i) {
    PredictedHorizon& horizon = moment.horizons.emplace_back();
    ENGRAM_ASSIGN_OR_RETURN(horizon.actual,
                            actual_of(source, entity, predicted[i].time, from, step));
    if (horizon.actual) {
      const std::vector<std::string> uncounted = uncounted_in(predicted[i]);
      horizon.error = error_of(*horizon.actual, predicted[i], uncounted);
      horizon.copy_error = error_of(*horizon.actual, copied[i], uncounted);
    }
    horizon.copy_told = told_by(copied[i]);
    horizon.predicted = std::move(predicted[i]);
  }
  return moment;
}

Result<std::vector<PredictionQuality>> sweep(Recall& recall, const MemoryId& entity,
                                             Recall::PredictionRequest request,
                                             const SweepOptions& options,
                                             const ProgressSink& progress,
                                             const std::stop_token& stop) {
  if (options.every == 0)
    return invalid_argument("sweep: found every 0th snapshot, needs at least every 1st");
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<Time> times, times_of(recall, entity));
  std::vector<Time> moments;
  for (const Sequence& sequence : cut_sequences(times))
    for (size_t row = sequence.first + 1; row < sequence.end; ++row)
      if (times[row] >= options.first.value_or(times.front()) &&
          times[row] <= options.last.value_or(times.back()))
        moments.push_back(times[row]);
  ENGRAM_ASSIGN_OR_RETURN(const auto engines, recall.engines(entity));
  ENGRAM_ASSIGN_OR_RETURN(const Duration step, step_of(recall, entity, engines.front()));
  const PredictionSource source = source_of(recall, entity);
  const size_t count = request.horizons.size();
  std::vector<PredictionSums> predicted(count), copied(count), moving(count), moving_copied(count);
  for (size_t i = 0; i < moments.size(); i += options.every) {
    if (stop.stop_requested()) return cancelled("predicting was stopped");
    if (progress) progress({"predict " + entity.to_string(), i, moments.size(), {}, -1});
    request.from = moments[i];
    request.learns_on = true;
    ENGRAM_ASSIGN_OR_RETURN(const PredictedMoment moment,
                            predict_moment(source, entity, request, step));
    for (size_t h = 0; h < moment.horizons.size(); ++h) {
      const PredictedHorizon& horizon = moment.horizons[h];
      if (!horizon.error || !horizon.copy_error) continue;
      predicted[h].add(told_by(horizon.predicted), *horizon.error);
      copied[h].add(horizon.copy_told, *horizon.copy_error);
      if (!is_anything_moving(horizon.predicted)) continue;
      moving[h].add(told_by(horizon.predicted), *horizon.error);
      moving_copied[h].add(horizon.copy_told, *horizon.copy_error);
    }
  }
  std::vector<PredictionQuality> qualities;
  for (size_t h = 0; h < predicted.size(); ++h)
    qualities.push_back({static_cast<int>(h + 1), predicted[h].quality.quality(),
                         copied[h].quality.quality(), predicted[h].bound_coverage(),
                         copied[h].bound_coverage(), moving[h].quality.quality(),
                         moving_copied[h].quality.quality()});
  return qualities;
}

}  // namespace engram::training
