// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/model_rollouts.h"

#include <algorithm>
#include <cmath>

#include "ltm/idf/binary.h"

namespace engram::ltm {

namespace {

/// The distinct `steps` that are not known yet.
template <typename IsKnown>
std::vector<int> missing_of(std::span<const int> steps, IsKnown is_known) {
  std::vector<int> missing;
  std::ranges::copy_if(steps, std::back_inserter(missing),
                       [&](int step) { return !is_known(step); });
  std::ranges::sort(missing);
  missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
  return missing;
}

}  // namespace

int model_steps(const Predictor& predictor, Duration ahead) {
  if (predictor.step() <= Duration(0)) return 1;
  return static_cast<int>(
      std::clamp(std::round(to_seconds(ahead) / to_seconds(predictor.step())), 1.0, 1e9));
}

void ModelRollouts::on_added(bool is_new_layout) {
  kept_.clear();
  kept_bytes_ = 0;
  // Predictions start from the last value and are void now. Errors of past rows stay true, so only
  // those of rows that the history dropped are removed: a new snapshot costs only its own rollouts.
  if (is_new_layout) errors_.clear();
  const uint64_t first = history_.series().added() - history_.values().size();
  while (!errors_.empty() && std::get<0>(errors_.begin()->first) < first)
    errors_.erase(errors_.begin());
}

Result<std::vector<Prediction>> ModelRollouts::ahead(const Engine& model,
                                                     std::span<const int> steps) {
  const std::string name(model.predictor->name());
  const std::vector<int> missing = missing_of(steps, [&](int step) {
    return kept_.contains({name, step});
  });
  std::map<int, Prediction> made;
  if (!missing.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(auto predicted, from(model, history_.values().size() - 1, missing));
    for (size_t i = 0; i < missing.size(); ++i) made.emplace(missing[i], std::move(predicted[i]));
  }
  std::vector<Prediction> predictions;
  for (const int step : steps) {
    const auto one = made.find(step);
    predictions.push_back(one != made.end() ? one->second : kept_.at({name, step}));
  }
  for (auto& [step, prediction] : made) {
    const size_t bytes = idf::encoded_size(prediction.value);
    if (kept_bytes_ + bytes > kMaxKeptBytes) break;
    kept_bytes_ += bytes;
    kept_.insert_or_assign({name, step}, std::move(prediction));
  }
  return predictions;
}

Result<std::vector<std::optional<MemberErrors>>> ModelRollouts::errors(const Engine& model,
                                                                       size_t row,
                                                                       std::span<const int> steps) {
  const NumberSeries& series = history_.series();
  const uint64_t place = series.added() - series.rows() + row;
  const std::string name(model.predictor->name());
  const std::vector<int> missing = missing_of(steps, [&](int step) {
    return errors_.contains({place, name, step});
  });
  if (!missing.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto predicted,
                            from(model, row - history_.row_of_value(0), missing));
    for (size_t i = 0; i < missing.size(); ++i) {
      const size_t then = row + series.steps_in(model.predictor->step() * int64_t{missing[i]});
      std::optional<MemberErrors> error;
      if (then < series.rows() && series.run_start(then) <= row) {
        ENGRAM_ASSIGN_OR_RETURN(error, history_.error_of(predicted[i].value, row, then));
      }
      errors_.insert_or_assign({place, name, missing[i]}, std::move(error));
    }
  }
  std::vector<std::optional<MemberErrors>> known;
  for (const int step : steps) known.push_back(errors_.at({place, name, step}));
  return known;
}

Result<std::vector<Prediction>> ModelRollouts::from(const Engine& model, size_t value,
                                                    std::span<const int> steps) const {
  const std::deque<idf::Data>& all = history_.values();
  const size_t count = std::min(std::max<size_t>(model.predictor->context(), 1), value + 1);
  std::vector<idf::Data> values, conditions;
  const auto condition = model.predictor->condition();
  for (size_t i = value + 1 - count; i <= value; ++i) {
    values.push_back(all[i]);
    if (!condition || !inputs_.condition_at) continue;
    ENGRAM_ASSIGN_OR_RETURN(
        auto known,
        inputs_.condition_at(*condition, history_.series().time(history_.row_of_value(i))));
    if (known) conditions.push_back(std::move(*known));
  }
  // A model takes conditions for all values or for none.
  if (conditions.size() != values.size()) conditions.clear();
  auto predicted = model.predictor->predict_at(Past(values, conditions), steps);
  if (!predicted.ok())
    return predicted.status().with_context("prediction of " + inputs_.entity.to_string());
  if (predicted->size() != steps.size())
    return data_loss("model {}: predicted {} moments, needs {}", model.model, predicted->size(),
                     steps.size());
  return predicted;
}

}  // namespace engram::ltm
