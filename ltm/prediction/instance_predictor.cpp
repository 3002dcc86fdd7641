// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/instance_predictor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "ltm/core/not_a_number.h"
#include "ltm/prediction/honest_error.h"
#include "ltm/prediction/member_summary.h"

namespace engram::ltm {

namespace {

/// Mean and bound of one kind of error; NaN if there is no error.
template <typename Kind>
MemberRecord spread_of(std::span<const MeasuredError> errors, Kind kind) {
  std::vector<double> known;
  for (const MeasuredError& error : errors) known.push_back(error.*kind);
  return MemberRecord::of(std::move(known));
}

EngineRecord record_of(std::string_view engine, const std::string& model,
                       std::span<const MeasuredError> errors) {
  const MemberRecord images = spread_of(errors, &MeasuredError::image_mse);
  const MemberRecord numbers = spread_of(errors, &MeasuredError::number_mse);
  return EngineRecord{std::string(engine),
                      model,
                      errors.size(),
                      {images.mean, numbers.mean},
                      {images.bound, numbers.bound}};
}

}  // namespace

InstancePredictor::InstancePredictor(const EngineChoiceInputs& inputs)
    : inputs_(inputs), history_(inputs), rollouts_(inputs, history_) {}

void InstancePredictor::add(Time time, const idf::Data& value) {
  const bool is_new = history_.add(time, value);
  rollouts_.on_added(is_new);
  if (is_new)
    predictor_ = std::make_unique<SeriesPredictor>(
        history_.series(), history_.rows(),
        SeriesPredictor::Options{history_.window().rows, history_.window().predictions,
                                 history_.has_models()});
}

std::vector<std::string> InstancePredictor::engines() const {
  std::vector<std::string> names;
  for (const Engine& model : inputs_.models)
    if (model.predictor->name() != kCopyLast) names.emplace_back(model.predictor->name());
  if (!history_.rows().has_continued()) {
    names.emplace_back(kCopyLast);
    return names;
  }
  for (const auto& engine : make_series_engines()) names.emplace_back(engine->name());
  return names;
}

/// The errors of copying the members that are not in rows `steps` steps ahead, from the rows that
/// engines are measured on.
std::vector<MeasuredError> InstancePredictor::copied_errors(size_t steps) const {
  std::vector<MeasuredError> errors;
  for (const size_t row : predictor_->test_rows(steps))
    if (const auto error = history_.copied_error(row, row + steps)) errors.push_back(error->pooled);
  return errors;
}

std::vector<EngineRecord> InstancePredictor::series_records(Duration ahead) {
  const ValueRow& rows = history_.rows();
  const std::vector<MeasuredError> copied = copied_errors(history_.series().steps_in(ahead));
  const EngineRecord of_copies = record_of(kCopyLast, "", copied);
  if (rows.counted() == 0) return {of_copies};
  std::vector<EngineRecord> records;
  const size_t others = history_.samples().number_elements();
  for (const SeriesRecord& one : predictor_->records(ahead)) {
    if (!rows.has_continued() && one.engine != kCopyLast) continue;
    EngineRecord& record = records.emplace_back(EngineRecord{one.engine, "", one.predictions});
    if (one.predictions == 0) continue;
    const auto square = [](double rmse) { return finite_or_nan(rmse * rmse); };
    record.mean = {of_copies.mean.image_mse, joined_error(square(one.rmse), rows.counted(),
                                                          of_copies.mean.number_mse, others)};
    record.bound = {of_copies.bound.image_mse, joined_error(square(one.bound_rmse), rows.counted(),
                                                            of_copies.bound.number_mse, others)};
  }
  return records;
}

Result<std::vector<EngineRecord>> InstancePredictor::records(Duration ahead) {
  std::vector<EngineRecord> records;
  for (const Engine& model : inputs_.models) {
    if (model.predictor->name() == kCopyLast) continue;
    ENGRAM_ASSIGN_OR_RETURN(records.emplace_back(), model_record(model, ahead));
  }
  std::ranges::move(series_records(ahead), std::back_inserter(records));
  return records;
}

/// The errors of the model's predictions from the rows that engines are measured on. Empty if
/// values have another layout than the model: then it cannot be measured.
Result<std::vector<std::pair<size_t, MemberErrors>>> InstancePredictor::model_errors(
    const Engine& model, Duration ahead) {
  std::vector<std::pair<size_t, MemberErrors>> errors;
  const int steps = model_steps(*model.predictor, ahead);
  for (const size_t row : predictor_->test_rows(history_.series().steps_in(ahead))) {
    if (row < history_.row_of_value(0)) continue;
    auto known = rollouts_.errors(model, row, {&steps, 1});
    if (known.status().code() == StatusCode::kInvalidArgument) break;
    ENGRAM_RETURN_IF_ERROR(known.status());
    if (known->front()) errors.emplace_back(row, *std::move(known->front()));
  }
  // The model may have been trained on these very rows.
  make_honest(inputs_, history_.rows().layout(), model, steps,
              copied_baseline(history_, errors, ahead), errors);
  return errors;
}

Result<EngineRecord> InstancePredictor::model_record(const Engine& model, Duration ahead) {
  ENGRAM_ASSIGN_OR_RETURN(const auto errors, model_errors(model, ahead));
  std::vector<MeasuredError> pooled;
  for (const auto& [row, error] : errors) pooled.push_back(error.pooled);
  return record_of(model.predictor->name(), model.model, pooled);
}

/// Measures models with one rollout per row for all horizons: a rollout to the farthest one passes
/// the others, and running a model is what a first answer waits for.
Status InstancePredictor::measure_models(std::span<const Duration> horizons,
                                         const std::string& engine) {
  for (const Engine& model : inputs_.models) {
    const std::string_view name = model.predictor->name();
    if (name == kCopyLast || (!engine.empty() && name != engine)) continue;
    std::map<size_t, std::vector<int>> steps_from;
    for (const Duration ahead : horizons)
      for (const size_t row : predictor_->test_rows(history_.series().steps_in(ahead)))
        if (row >= history_.row_of_value(0))
          steps_from[row].push_back(model_steps(*model.predictor, ahead));
    for (const auto& [row, steps] : steps_from) {
      const Status status = rollouts_.errors(model, row, steps).status();
      if (status.code() == StatusCode::kInvalidArgument) break;
      ENGRAM_RETURN_IF_ERROR(status);
    }
  }
  return {};
}

std::vector<bool> InstancePredictor::moving(size_t row) {
  std::vector<bool> moving(history_.rows().layout().members().size(), false);
  const std::vector<bool> of_rows = predictor_->moving_members(row);
  for (size_t i = 0; i < of_rows.size(); ++i)
    moving[history_.rows().row_members()[i].member] = of_rows[i];
  return moving;
}

/// The candidate that copies, followed by all others or only the named one.
std::vector<MemberCandidate> InstancePredictor::series_candidates(Duration ahead,
                                                                  const std::string& engine) {
  const ValueRow& rows = history_.rows();
  const size_t members = rows.layout().members().size();
  std::vector<MemberCandidate> candidates;
  const std::array<std::string_view, 2> names{kCopyLast, engine};
  const std::span<const std::string_view> wanted =
      engine.empty() ? std::span<const std::string_view>() : names;
  for (const MemberRecords& one : predictor_->member_records(ahead, wanted)) {
    MemberCandidate& candidate = candidates.emplace_back(
        MemberCandidate{one.engine, nullptr, std::vector<MotionRecords>(members)});
    for (size_t i = 0; i < one.members.size(); ++i)
      candidate.members[rows.row_members()[i].member] = one.members[i];
    if (!rows.has_continued()) break;
  }
  const size_t steps = history_.series().steps_in(ahead);
  std::vector<std::vector<double>> squares(members);
  for (const size_t row : predictor_->test_rows(steps))
    if (const auto error = history_.copied_error(row, row + steps))
      for (const size_t member : rows.other_members())
        squares[member].push_back(error->squares[member]);
  for (const size_t member : rows.other_members())
    candidates.front().members[member].at_rest = MemberRecord::of(std::move(squares[member]));
  return candidates;
}

Result<MemberCandidate> InstancePredictor::model_candidate(const Engine& model, Duration ahead) {
  ENGRAM_ASSIGN_OR_RETURN(const auto errors, model_errors(model, ahead));
  std::vector<MotionErrors> members(history_.rows().layout().members().size());
  for (const auto& [row, error] : errors) {
    const std::vector<bool> is_moving = moving(row);
    for (size_t i = 0; i < members.size(); ++i) members[i].add(is_moving[i], error.squares[i]);
  }
  MemberCandidate candidate{std::string(model.predictor->name()), &model, {}};
  for (MotionErrors& one : members) candidate.members.push_back(std::move(one).records());
  return candidate;
}

Result<InstancePredictor::Plan> InstancePredictor::plan(Duration ahead, const std::string& engine,
                                                        const std::vector<bool>& is_moving) {
  Plan plan{series_candidates(ahead, engine), {}};
  for (const Engine& model : inputs_.models) {
    const std::string_view name = model.predictor->name();
    if (name == kCopyLast || (!engine.empty() && name != engine)) continue;
    ENGRAM_ASSIGN_OR_RETURN(plan.candidates.emplace_back(), model_candidate(model, ahead));
  }
  plan.choices = engine.empty() ? choose_members(plan.candidates, history_.rows(), is_moving)
                                : named_members(plan.candidates, history_.rows(), is_moving);
  return plan;
}

Result<std::vector<InstancePrediction>> InstancePredictor::predict(
    std::span<const Duration> horizons, const std::string& engine) {
  ENGRAM_RETURN_IF_ERROR(measure_models(horizons, engine));
  const std::vector<bool> is_moving = moving(history_.series().rows() - 1);
  std::vector<Plan> plans;
  std::map<const Engine*, std::vector<size_t>> asked;  // The horizons of each model.
  for (const Duration ahead : horizons) {
    ENGRAM_ASSIGN_OR_RETURN(Plan one, plan(ahead, engine, is_moving));
    std::set<const Engine*> models;
    for (const MemberChoice& choice : one.choices)
      models.insert(one.candidates[choice.candidate].model);
    // Values without any tensor member have no choices, so the named model is taken for them.
    if (one.choices.empty() && one.candidates.back().model != nullptr && !engine.empty())
      models.insert(one.candidates.back().model);
    for (const Engine* model : models)
      if (model != nullptr) asked[model].push_back(plans.size());
    plans.push_back(std::move(one));
  }
  std::vector<std::map<const Engine*, Prediction>> predicted(plans.size());
  for (const auto& [model, places] : asked) {
    std::vector<int> steps;
    for (const size_t place : places)
      steps.push_back(model_steps(*model->predictor, horizons[place]));
    ENGRAM_ASSIGN_OR_RETURN(auto predictions, rollouts_.ahead(*model, steps));
    for (size_t i = 0; i < places.size(); ++i)
      predicted[places[i]].emplace(model, std::move(predictions[i]));
  }
  std::vector<InstancePrediction> results;
  for (size_t i = 0; i < plans.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(results.emplace_back(),
                            joined(horizons[i], plans[i], is_moving, predicted[i]));
  }
  return results;
}

Result<InstancePrediction> InstancePredictor::by_model(const Engine& model,
                                                       const Prediction& predicted) {
  constexpr size_t kCopy = 0, kModel = 1;
  const ValueRow& rows = history_.rows();
  const size_t members = rows.layout().members().size();
  // Nothing was measured with the plan, so members have no records and take the model's estimate.
  const Plan plan{
      {{std::string(kCopyLast), nullptr, std::vector<MotionRecords>(members)},
       {std::string(model.predictor->name()), &model, std::vector<MotionRecords>(members)}},
      [&] {
        std::vector<MemberChoice> choices(members, MemberChoice{kModel, {}});
        for (const RowMember& member : rows.row_members())
          if (member.is_copied) choices[member.member].candidate = kCopy;
        return choices;
      }()};
  return joined({}, plan, moving(history_.series().rows() - 1), {{&model, predicted}});
}

/// Joins what each member's engine predicts to one value.
Result<InstancePrediction> InstancePredictor::joined(
    Duration ahead, const Plan& plan, const std::vector<bool>& is_moving,
    const std::map<const Engine*, Prediction>& models) {
  const ValueRow& rows = history_.rows();
  const std::span<const double> last = history_.last_row();
  std::vector<double> row(last.begin(), last.end());
  std::map<std::string, std::vector<double>> continued;
  for (const RowMember& member : rows.row_members()) {
    const MemberCandidate& used = plan.candidates[plan.choices[member.member].candidate];
    if (used.model != nullptr || used.engine == kCopyLast) continue;
    auto known = continued.find(used.engine);
    if (known == continued.end())
      known = continued.emplace(used.engine, predictor_->continued(ahead, used.engine)).first;
    const auto from = known->second.begin() + static_cast<std::ptrdiff_t>(member.first);
    std::copy_n(from, member.count, row.begin() + static_cast<std::ptrdiff_t>(member.first));
  }
  InstancePrediction prediction;
  if (models.size() == 1 && !rows.layout().split(models.begin()->second.value).ok()) {
    // A named model may predict members that the values do not have: its value is answered whole.
    const auto& [model, one] = *models.begin();
    return InstancePrediction{one.value, model->model, one.error, {whole_prediction(*model, one)}};
  }
  prediction.value =
      continued.empty() ? history_.values().back() : rows.value(history_.last(), last, row);
  if (!models.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(idf::SplitValue parts, rows.layout().split(prediction.value));
    for (const auto& [model, one] : models) {
      const auto split = rows.layout().split(one.value);
      if (!split.ok()) return split.status().with_context("prediction by " + model->model);
      for (size_t i = 0; i < plan.choices.size(); ++i)
        if (plan.candidates[plan.choices[i].candidate].model == model)
          parts.tensors[i] = split->tensors[i];
      prediction.model = model->model;
    }
    ENGRAM_ASSIGN_OR_RETURN(prediction.value, rows.layout().join(parts));
  }
  summarize(rows, plan.candidates, plan.choices, is_moving, models, prediction.members,
            prediction.error);
  return prediction;
}

}  // namespace engram::ltm
