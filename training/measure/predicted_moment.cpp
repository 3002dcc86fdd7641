// SPDX-License-Identifier: Apache-2.0
#include "training/measure/predicted_moment.h"

#include <algorithm>
#include <cmath>

#include "training/fit/sequences.h"
#include "training/measure/quality_sums.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {

namespace {

using ltm::MemoryId;
using ltm::Recall;
using ltm::SnapshotResult;

/// Number of last snapshots whose median interval is the step.
constexpr size_t kStepTimes = 1000;

Result<std::vector<Time>> times_of(Recall& recall, const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, recall.store().index(entity));
  std::vector<Time> times;
  for (const ltm::SnapshotEntry& entry : *index) times.push_back(entry.time);
  return times;
}

/// Times of the last snapshots. Not all are read, because a store may hold millions.
Result<std::vector<Time>> newest_times_of(Recall& recall, const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, recall.store().timeline(entity));
  std::vector<Time> times;
  for (std::optional<Time> at = timeline->last(); at && times.size() < kStepTimes;) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_before(*at));
    if (!entry) break;
    times.push_back(entry->time);
    at = entry->time > Time::min() ? std::optional(entry->time - Duration(1)) : std::nullopt;
  }
  std::ranges::reverse(times);
  return times;
}

/// The snapshot that a selector finds, if there is one.
Result<std::optional<SnapshotResult>> only_snapshot(Recall& recall, const MemoryId& entity,
                                                    const ltm::Selector& selector) {
  ENGRAM_ASSIGN_OR_RETURN(auto answer, recall.query(ltm::Query::of_entity(entity, selector)));
  const auto& snapshots = answer.entities().front()->snapshots;
  return snapshots.empty() ? std::nullopt : std::optional(snapshots.front());
}

/// The snapshot closest to `when`, later than the one from which the prediction was made.
Result<std::optional<SnapshotResult>> actual_of(Recall& recall, const MemoryId& entity, Time when,
                                                Time from, Duration step) {
  // One nanosecond less than half a step, so that a snapshot in the middle of two moments belongs
  // to neither.
  const Duration tolerance = std::max(Duration(0), (step - Duration(1)) / 2);
  ENGRAM_ASSIGN_OR_RETURN(auto found,
                          only_snapshot(recall, entity, ltm::select::Nearest{when, tolerance}));
  if (found && (found->time <= from || found->source == ltm::Source::kPredicted)) found.reset();
  return found;
}

/// Compares the first instances; nothing if they have different layouts.
std::optional<ltm::MeasuredError> error_of(const SnapshotResult& actual,
                                           const SnapshotResult& other) {
  if (actual.instances.empty() || other.instances.empty()) return std::nullopt;
  const auto error =
      compare_prediction(actual.instances.front().data, other.instances.front().data);
  return error.ok() ? std::optional(*error) : std::nullopt;
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

Result<Duration> step_of(Recall& recall, const MemoryId& entity, const Recall::Engine& engine) {
  if (engine.predictor->step() > Duration(0)) return engine.predictor->step();
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<Time> times, newest_times_of(recall, entity));
  return median_step(times);
}

Result<Time> last_known_from(Recall& recall, const MemoryId& entity, Duration ahead) {
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<Time> times, times_of(recall, entity));
  for (auto from = times.rbegin(); from != times.rend(); ++from)
    if (times.back() - *from >= ahead) return *from;
  return not_found("entity '{}': has no two snapshots {} apart", entity.to_string(),
                   engram::to_string(ahead));
}

Result<PredictedMoment> predict_moment(Recall& recall, const MemoryId& entity,
                                       const Recall::PredictionRequest& request) {
  ENGRAM_ASSIGN_OR_RETURN(auto predicted, recall.predict(entity, request, {}));
  Recall::PredictionRequest copying = request;
  copying.engine = ltm::kCopyLast;
  copying.plan.reset();
  ENGRAM_ASSIGN_OR_RETURN(const auto copied, recall.predict(entity, copying, {}));
  ENGRAM_ASSIGN_OR_RETURN(const auto engines, recall.engines(entity));
  ENGRAM_ASSIGN_OR_RETURN(const Duration step, step_of(recall, entity, engines.front()));
  const Time from = predicted.front().time - predicted.front().horizon;
  ENGRAM_ASSIGN_OR_RETURN(auto last, only_snapshot(recall, entity, ltm::select::At{from}));
  ENGRAM_CHECK(last.has_value(), "'{}' was predicted from", entity.at(from).to_string());
  PredictedMoment moment{std::move(*last), {}};
  for (size_t i = 0; i < predicted.size(); ++i) {
    PredictedHorizon& horizon = moment.horizons.emplace_back();
    ENGRAM_ASSIGN_OR_RETURN(horizon.actual,
                            actual_of(recall, entity, predicted[i].time, from, step));
    if (horizon.actual) {
      horizon.error = error_of(*horizon.actual, predicted[i]);
      horizon.copy_error = error_of(*horizon.actual, copied[i]);
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
  const size_t count = request.horizons.size();
  std::vector<PredictionSums> predicted(count), copied(count), moving(count), moving_copied(count);
  for (size_t i = 0; i < moments.size(); i += options.every) {
    if (stop.stop_requested()) return cancelled("predicting was stopped");
    if (progress) progress({"predict " + entity.to_string(), i, moments.size(), {}, -1});
    request.from = moments[i];
    ENGRAM_ASSIGN_OR_RETURN(const PredictedMoment moment, predict_moment(recall, entity, request));
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
