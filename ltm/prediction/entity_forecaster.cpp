// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/entity_forecaster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ltm/prediction/instance_forecaster.h"

namespace engram::ltm {

namespace {

/// Adds an instance's mean to the mean of others, by how many predictions they are of.
void pool(double& mean, double& bound, uint64_t count, double more_mean, double more_bound,
          uint64_t more) {
  if (std::isnan(more_mean) || more == 0) return;
  if (std::isnan(mean) || count == 0) {
    mean = more_mean;
    bound = more_bound;
    return;
  }
  const auto ours = static_cast<double>(count), theirs = static_cast<double>(more);
  mean = (mean * ours + more_mean * theirs) / (ours + theirs);
  bound = std::max(bound, more_bound);
}

void pool(EngineRecord& all, const EngineRecord& one) {
  pool(all.mean.image_mse, all.bound.image_mse, all.predictions, one.mean.image_mse,
       one.bound.image_mse, one.predictions);
  pool(all.mean.number_mse, all.bound.number_mse, all.predictions, one.mean.number_mse,
       one.bound.number_mse, one.predictions);
  all.predictions += one.predictions;
}

/// -1, 0, 1: which of two errors is smaller; one that is not known is larger than any.
int compared(double a, double b) {
  if (std::isnan(a) || std::isnan(b))
    return static_cast<int>(std::isnan(a)) - static_cast<int>(std::isnan(b));
  return static_cast<int>(a > b) - static_cast<int>(a < b);
}

/// Measured before unmeasured; then images decide, then numbers.
bool is_better(const EngineRecord& a, const EngineRecord& b) {
  if ((a.predictions > 0) != (b.predictions > 0)) return a.predictions > 0;
  const int images = compared(a.mean.image_mse, b.mean.image_mse);
  if (images != 0) return images < 0;
  return compared(a.mean.number_mse, b.mean.number_mse) < 0;
}

}  // namespace

EntityForecaster::EntityForecaster(EngineChoiceInputs inputs) : inputs_(std::move(inputs)) {}

EntityForecaster::~EntityForecaster() = default;

size_t EntityForecaster::snapshots_wanted(const Snapshot& newest) const {
  size_t most = 1;
  for (const Instance& instance : newest.instances)
    most = std::max(most, InstanceForecaster(inputs_).values_wanted(instance.data));
  return most;
}

Status EntityForecaster::add(const Snapshot& snapshot) {
  if (snapshot.entity != inputs_.entity)
    return invalid_argument("forecaster of '{}': found a snapshot of '{}'",
                            inputs_.entity.to_string(), snapshot.entity.to_string());
  if (last_ && snapshot.time <= *last_)
    return invalid_argument("forecaster of '{}': found {}, needs a moment after {}",
                            inputs_.entity.to_string(), to_string(snapshot.time),
                            to_string(*last_));
  last_ = snapshot.time;
  metadata_.clear();
  for (const Instance& instance : snapshot.instances) {
    if (instances_.size() == metadata_.size())
      instances_.push_back(std::make_unique<InstanceForecaster>(inputs_));
    instances_[metadata_.size()]->add(snapshot.time, instance.data);
    metadata_.push_back(instance.metadata);
  }
  return {};
}

std::vector<std::string> EntityForecaster::engines() const {
  std::vector<std::string> names;
  for (size_t i = 0; i < metadata_.size(); ++i)
    for (std::string& name : instances_[i]->engines())
      if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
  return names;
}

Result<EntityForecaster::Measured> EntityForecaster::measured(Duration ahead,
                                                              const std::string& only) {
  Measured measured;
  for (size_t i = 0; i < metadata_.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(measured.instances.emplace_back(), instances_[i]->records(ahead, only));
    for (const EngineRecord& one : measured.instances.back()) {
      const auto known = std::ranges::find(measured.pooled, one.engine, &EngineRecord::engine);
      if (known == measured.pooled.end())
        measured.pooled.push_back(one);
      else
        pool(*known, one);
    }
  }
  // Models stand first, the last value after them: so they do where nothing tells which is better.
  std::ranges::stable_sort(measured.pooled, is_better);
  return measured;
}

Result<std::vector<EngineRecord>> EntityForecaster::records(Duration ahead) {
  if (!last_) return not_found("entity '{}': has no snapshot", inputs_.entity.to_string());
  ENGRAM_ASSIGN_OR_RETURN(Measured measured, this->measured(ahead, {}));
  return std::move(measured.pooled);
}

Result<SnapshotResult> EntityForecaster::predicted(Duration ahead, const std::string& engine) {
  ENGRAM_ASSIGN_OR_RETURN(const Measured measured, this->measured(ahead, engine));
  SnapshotResult result;
  result.time = *last_ + ahead;
  result.source = Source::kPredicted;
  result.horizon = ahead;
  result.predictor = measured.pooled.empty() ? "copy-last" : measured.pooled.front().engine;
  if (!measured.pooled.empty()) result.model = measured.pooled.front().model;
  for (size_t i = 0; i < metadata_.size(); ++i) {
    auto own = measured.instances[i];
    auto known = std::ranges::find(own, result.predictor, &EngineRecord::engine);
    if (known == own.end()) {  // Without numbers it has no engines of them: it is copied.
      ENGRAM_ASSIGN_OR_RETURN(own, instances_[i]->records(ahead, "copy-last"));
      known = own.begin();
    }
    ENGRAM_ASSIGN_OR_RETURN(Prediction one, instances_[i]->predict(ahead, *known));
    InstanceMetadata metadata = metadata_[i];
    metadata.created = metadata.sent = metadata.arrived = result.time;
    result.append(std::move(one.value), metadata, one.error.expected, one.error.bound);
  }
  return result;
}

Result<std::vector<SnapshotResult>> EntityForecaster::predict(std::span<const Duration> horizons,
                                                              const std::string& engine) {
  if (!last_) return not_found("entity '{}': has no snapshot", inputs_.entity.to_string());
  const std::vector<std::string> known = engines();
  if (!engine.empty() && !known.empty() && std::ranges::find(known, engine) == known.end())
    return not_found("entity '{}': nothing named '{}' predicts it; there is: {}",
                     inputs_.entity.to_string(), engine, fmt::join(known, ", "));
  // The longest first: a model predicts the shorter ones on its way.
  const Duration longest = horizons.empty() ? Duration(0) : std::ranges::max(horizons);
  if (engine.empty() && longest > Duration(0))
    ENGRAM_RETURN_IF_ERROR(measured(longest, engine).status());
  std::vector<SnapshotResult> results;
  for (const Duration ahead : horizons) {
    if (ahead <= Duration(0) || ahead.count() > INT64_MAX - std::max<int64_t>(0, to_ns(*last_)))
      return invalid_argument("entity '{}': found a horizon of {}, needs a moment after {}",
                              inputs_.entity.to_string(), to_string(ahead), to_string(*last_));
    ENGRAM_ASSIGN_OR_RETURN(results.emplace_back(), predicted(ahead, engine));
  }
  return results;
}

std::unique_ptr<EngineChoice> make_entity_forecaster(EngineChoiceInputs inputs) {
  return std::make_unique<EntityForecaster>(std::move(inputs));
}

}  // namespace engram::ltm
