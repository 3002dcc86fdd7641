// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/entity_predictor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ltm/prediction/instance_predictor.h"

namespace engram::ltm {

namespace {

/// The name if several engines predicted: then each member of an answer names its own.
constexpr std::string_view kMixed = "mixed";

/// Adds the mean of one instance to that of others, weighted by their numbers of predictions. The
/// bound becomes the larger one.
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

/// Returns -1, 0 or 1 if `a` is smaller, equal or larger. An unknown error is larger than any
/// known one.
int compared(double a, double b) {
  if (std::isnan(a) || std::isnan(b))
    return static_cast<int>(std::isnan(a)) - static_cast<int>(std::isnan(b));
  return static_cast<int>(a > b) - static_cast<int>(a < b);
}

/// Orders measured engines before unmeasured ones, then by image errors, then by number errors.
bool is_better(const EngineRecord& a, const EngineRecord& b) {
  if ((a.predictions > 0) != (b.predictions > 0)) return a.predictions > 0;
  const int images = compared(a.mean.image_mse, b.mean.image_mse);
  if (images != 0) return images < 0;
  const int numbers = compared(a.mean.number_mse, b.mean.number_mse);
  if (numbers != 0) return numbers < 0;
  // What is as good as a copy may well be one.
  return a.predictions > 0 && a.engine == kCopyLast && b.engine != kCopyLast;
}

/// True if the member has an error or would have one. Bools and times have none.
bool is_predicted(const MemberPrediction& member) {
  return member.engine != kCopyLast || !std::isnan(member.expected_mse);
}

}  // namespace

std::string engine_of(const SnapshotResult& predicted, const std::string& named) {
  std::string only;
  for (const InstanceResult& instance : predicted.instances)
    for (const MemberPrediction& member : instance.members) {
      if (member.engine == named && !named.empty()) return named;
      if (!is_predicted(member) || member.engine == only) continue;
      if (!only.empty()) return named.empty() ? std::string(kMixed) : std::string(kCopyLast);
      only = member.engine;
    }
  return only.empty() || !named.empty() ? std::string(kCopyLast) : only;
}

EntityPredictor::EntityPredictor(EngineChoiceInputs inputs) : inputs_(std::move(inputs)) {}

EntityPredictor::~EntityPredictor() = default;

size_t EntityPredictor::snapshots_wanted(const Snapshot& newest) const {
  size_t max = 1;
  for (const Instance& instance : newest.instances)
    max = std::max(max, InstancePredictor(inputs_).values_wanted(instance.data));
  return max;
}

Status EntityPredictor::add(const Snapshot& snapshot) {
  if (snapshot.entity != inputs_.entity)
    return invalid_argument("predictor of '{}': found a snapshot of '{}'",
                            inputs_.entity.to_string(), snapshot.entity.to_string());
  if (last_ && snapshot.time <= *last_)
    return invalid_argument("predictor of '{}': found {}, needs a moment after {}",
                            inputs_.entity.to_string(), to_string(snapshot.time),
                            to_string(*last_));
  last_ = snapshot.time;
  metadata_.clear();
  for (const Instance& instance : snapshot.instances) {
    if (instances_.size() == metadata_.size())
      instances_.push_back(std::make_unique<InstancePredictor>(inputs_));
    instances_[metadata_.size()]->add(snapshot.time, instance.data);
    metadata_.push_back(instance.metadata);
  }
  return {};
}

std::vector<std::string> EntityPredictor::engines() const {
  std::vector<std::string> names;
  for (size_t i = 0; i < metadata_.size(); ++i)
    for (std::string& name : instances_[i]->engines())
      if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
  return names;
}

Result<std::vector<EngineRecord>> EntityPredictor::records(Duration ahead) {
  if (!last_) return not_found("entity '{}': has no snapshot", inputs_.entity.to_string());
  std::vector<EngineRecord> pooled;
  for (size_t i = 0; i < metadata_.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto records, instances_[i]->records(ahead));
    for (const EngineRecord& one : records) {
      const auto known = std::ranges::find(pooled, one.engine, &EngineRecord::engine);
      if (known == pooled.end())
        pooled.push_back(one);
      else
        pool(*known, one);
    }
  }
  // The sort is stable, so models, which come first, stay first if no error tells which is better.
  std::ranges::stable_sort(pooled, is_better);
  return pooled;
}

Result<std::vector<SnapshotResult>> EntityPredictor::predict(std::span<const Duration> horizons,
                                                             const std::string& engine) {
  if (!last_) return not_found("entity '{}': has no snapshot", inputs_.entity.to_string());
  const std::vector<std::string> known = engines();
  if (!engine.empty() && !known.empty() && std::ranges::find(known, engine) == known.end())
    return not_found("entity '{}': nothing named '{}' predicts it; there is: {}",
                     inputs_.entity.to_string(), engine, fmt::join(known, ", "));
  std::vector<SnapshotResult> results;
  for (const Duration ahead : horizons) {
    if (ahead <= Duration(0) || ahead.count() > INT64_MAX - std::max<int64_t>(0, to_ns(*last_)))
      return invalid_argument("entity '{}': found a horizon of {}, needs a moment after {}",
                              inputs_.entity.to_string(), to_string(ahead), to_string(*last_));
    SnapshotResult& result = results.emplace_back();
    result.time = *last_ + ahead;
    result.source = Source::kPredicted;
    result.horizon = ahead;
  }
  for (size_t i = 0; i < metadata_.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(auto predicted, instances_[i]->predict(horizons, engine));
    for (size_t k = 0; k < results.size(); ++k) {
      InstanceMetadata metadata = metadata_[i];
      metadata.created = metadata.sent = metadata.arrived = results[k].time;
      InstancePrediction& one = predicted[k];
      results[k].append(std::move(one.value), metadata, one.error.expected, one.error.bound);
      results[k].instances.back().members = std::move(one.members);
      if (!one.model.empty()) results[k].model = std::move(one.model);
    }
  }
  for (SnapshotResult& result : results) result.predictor = engine_of(result, engine);
  return results;
}

Result<InstancePrediction> EntityPredictor::by_model(size_t instance, const Engine& model,
                                                     const Prediction& predicted) {
  if (instance >= metadata_.size())
    return not_found("entity '{}': its last snapshot has no instance {}",
                     inputs_.entity.to_string(), instance);
  return instances_[instance]->by_model(model, predicted);
}

std::unique_ptr<EngineChoice> make_entity_predictor(EngineChoiceInputs inputs) {
  return std::make_unique<EntityPredictor>(std::move(inputs));
}

}  // namespace engram::ltm
