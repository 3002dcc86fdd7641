// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "encoders/deep_model.h"

namespace engram::encoders {

namespace {

/// Returns the value before the last one, or the last one if it is the only one.
Result<Parts> parts_before(const DeepModel& model, std::span<const idf::Data> history) {
  const idf::Data& before = history[history.size() > 1 ? history.size() - 2 : 0];
  ENGRAM_ASSIGN_OR_RETURN(const auto split, model.plan.layout().split(before));
  return model.to_parts(split);
}

/// Returns the difference of the last two values, which is not known if there is only one.
ltm::MeasuredError change_of(const DeepModel& model, std::span<const idf::Data> history,
                             const Parts& last, const Parts& before) {
  return history.size() > 1 ? model.difference(last, before) : ltm::MeasuredError{};
}

class DeepPredictor : public ltm::Predictor {
 public:
  explicit DeepPredictor(std::shared_ptr<DeepModel> model) : model_(std::move(model)) {}

  [[nodiscard]] std::string_view name() const override { return "deep"; }
  [[nodiscard]] Duration step() const override { return model_->prediction.step; }
  [[nodiscard]] size_t context() const override { return 2; }

  [[nodiscard]] std::optional<ltm::MemoryId> condition() const override {
    if (!model_->condition) return std::nullopt;
    const auto id = ltm::MemoryId::parse(model_->condition->entity);
    return id.ok() ? std::optional(*id) : std::nullopt;
  }

  Result<std::vector<ltm::Prediction>> predict(const ltm::Past& past, int steps) override {
    if (steps < 1) return invalid_argument("predict: found {} steps, needs at least 1", steps);
    std::vector<int> all(static_cast<size_t>(steps));
    std::iota(all.begin(), all.end(), 1);
    return predict_at(past, all);
  }

  Result<std::vector<ltm::Prediction>> predict_at(const ltm::Past& past,
                                                  std::span<const int> steps) override {
    if (past.values.empty()) return invalid_argument("predict: found no history, needs one value");
    for (const int step : steps)
      if (step < 1) return invalid_argument("predict: found step {}, needs at least 1", step);
    return guarded("predict", [&] { return predict_checked(past, steps); });
  }

  [[nodiscard]] std::vector<ltm::HorizonRecord> records(ltm::PredictorInputs told) const override {
    return record(told).horizons();
  }

 private:
  // Horizons that were not measured use the shares of the last measured one.
  static size_t index_of(int steps) {
    return static_cast<size_t>(std::clamp(steps, 1, kMeasuredHorizons) - 1);
  }

  [[nodiscard]] const PredictionRecord& record(ltm::PredictorInputs told) const {
    if (!model_->condition || told == ltm::PredictorInputs::kConditions) return model_->prediction;
    return told == ltm::PredictorInputs::kPlan ? model_->planned : model_->unconditioned;
  }

  [[nodiscard]] static BlendShares shares_at(const PredictionRecord& record, int step) {
    const size_t horizon = index_of(step);
    return {record.image_gates[horizon], record.motion_gates[horizon],
            record.number_gates[horizon]};
  }

  /// Predicts the values at `steps`, which may be in any order and may repeat.
  Result<std::vector<ltm::Prediction>> predict_checked(const ltm::Past& past,
                                                       std::span<const int> steps) {
    torch::NoGradGuard no_grad;
    const auto history = past.values;
    ENGRAM_ASSIGN_OR_RETURN(const auto split, model_->plan.layout().split(history.back()));
    ENGRAM_ASSIGN_OR_RETURN(Parts last, model_->to_parts(split));
    ENGRAM_ASSIGN_OR_RETURN(Parts before, parts_before(*model_, history));
    if (!model_->autoencoder->images.empty())
      last.scene = before.scene = model_->best_scene({&last, 1});
    const bool has_conditions =
        model_->condition && past.conditions.size() == history.size() &&
        add_conditions(past.conditions.back(), last) &&
        add_conditions(past.conditions[history.size() > 1 ? history.size() - 2 : 0], before);
    ltm::PredictorInputs told =
        has_conditions ? ltm::PredictorInputs::kConditions : ltm::PredictorInputs::kValues;
    if (has_conditions && !past.plan.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(last.plan, read_plan(past.plan));
      told = ltm::PredictorInputs::kPlan;
    }
    const PredictionRecord& record = this->record(told);
    const ltm::MeasuredError change = change_of(*model_, history, last, before);
    std::vector<FutureNeed> needs;
    for (const int step : std::set<int>(steps.begin(), steps.end())) {
      const BlendShares shares = shares_at(record, step);
      needs.push_back({step, shares.latents > 0 || shares.numbers > 0, shares.motion > 0});
    }
    const auto futures = futures_of(*model_, last, before, needs);
    std::map<int, ltm::Prediction> known;
    for (size_t i = 0; i < needs.size(); ++i) {
      const int step = needs[i].step;
      const BlendShares shares = shares_at(record, step);
      ENGRAM_ASSIGN_OR_RETURN(idf::Data value,
                              value_at(history.back(), split, last, futures[i], shares));
      known.emplace(step, ltm::Prediction{std::move(value), record.estimate(change, step),
                                          std::max(0.0, 1 - shares.latents - shares.motion),
                                          1 - shares.numbers});
    }
    std::vector<ltm::Prediction> predictions;
    for (const int step : steps) predictions.push_back(known.at(step));
    return predictions;
  }

  /// Shape: [1, P, K].
  Result<torch::Tensor> read_plan(std::span<const idf::Data> plan) const {
    std::vector<torch::Tensor> steps;
    for (const idf::Data& value : plan) {
      auto numbers = model_->condition->read(value);
      if (!numbers.ok()) return numbers.status().with_context("planned value");
      steps.push_back(*std::move(numbers));
    }
    return torch::stack(steps, 1);
  }

  /// Returns false if the condition has another layout now. Then it counts as not known.
  bool add_conditions(const idf::Data& value, Parts& parts) const {
    auto numbers = model_->condition->read(value);
    if (numbers.ok()) parts.conditions = *std::move(numbers);
    return parts.conditions.defined();
  }

  // Members whose gate is closed keep the last value bit for bit.
  Result<idf::Data> value_at(const idf::Data& newest, const idf::SplitValue& split,
                             const Parts& last, const Future& future,
                             const BlendShares& shares) const {
    const bool copies_images = shares.latents == 0 && shares.motion == 0;
    const bool copies_numbers = shares.numbers == 0;
    if (copies_images && copies_numbers) return newest;
    const Parts mixed = mix(last, future, shares);
    std::vector<double> numbers =
        model_->moved_numbers(model_->plan.read_numbers(split), last, mixed);
    model_->plan.make_orientations_unit(numbers);
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data value,
                            model_->to_value(model_->to_arrays(mixed), numbers, split.remainder));
    ENGRAM_ASSIGN_OR_RETURN(idf::SplitValue parts, model_->plan.layout().split(value));
    if (copies_images)
      for (const ImageMember& image : model_->plan.images())
        parts.tensors[image.member] = split.tensors[image.member];
    if (copies_numbers)
      for (const NumberMember& number : model_->plan.numbers())
        parts.tensors[number.member] = split.tensors[number.member];
    return model_->plan.layout().join(parts);
  }

  std::shared_ptr<DeepModel> model_;
};

class MeasuredCopies : public ltm::Predictor {
 public:
  explicit MeasuredCopies(std::shared_ptr<DeepModel> model) : model_(std::move(model)) {}

  [[nodiscard]] std::string_view name() const override { return "copy-last"; }
  [[nodiscard]] Duration step() const override { return model_->copied.step; }
  [[nodiscard]] size_t context() const override { return 2; }

  Result<std::vector<ltm::Prediction>> predict(const ltm::Past& past, int steps) override {
    ENGRAM_ASSIGN_OR_RETURN(auto copies, ltm::make_copy_last_predictor()->predict(past, steps));
    const auto change = guarded("predict", [&] { return change_before(past.values); });
    // A value of another layout is copied too, but without an estimate of its error.
    if (!change.ok() && change.status().code() != StatusCode::kInvalidArgument)
      return change.status();
    for (size_t i = 0; change.ok() && i < copies.size(); ++i)
      copies[i].error = model_->copied.estimate(*change, static_cast<int>(i + 1));
    return copies;
  }

  [[nodiscard]] std::vector<ltm::HorizonRecord> records(
      ltm::PredictorInputs /*told*/) const override {
    return model_->copied.horizons();
  }

 private:
  [[nodiscard]] Result<ltm::MeasuredError> change_before(std::span<const idf::Data> history) const {
    torch::NoGradGuard no_grad;
    ENGRAM_ASSIGN_OR_RETURN(const auto split, model_->plan.layout().split(history.back()));
    ENGRAM_ASSIGN_OR_RETURN(const Parts last, model_->to_parts(split));
    ENGRAM_ASSIGN_OR_RETURN(const Parts before, parts_before(*model_, history));
    return change_of(*model_, history, last, before);
  }

  std::shared_ptr<DeepModel> model_;
};

}  // namespace

std::unique_ptr<ltm::Predictor> make_predictor(std::shared_ptr<DeepModel> model) {
  return std::make_unique<DeepPredictor>(std::move(model));
}

std::unique_ptr<ltm::Predictor> make_copies(std::shared_ptr<DeepModel> model) {
  return std::make_unique<MeasuredCopies>(std::move(model));
}

}  // namespace engram::encoders
