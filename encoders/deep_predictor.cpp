// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "encoders/deep_model.h"

namespace engram::encoders {

namespace {

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

  Result<std::vector<idf::Data>> predict(const ltm::Past& past, int steps) override {
    if (past.values.empty()) return invalid_argument("predict: found no history, needs one value");
    if (steps < 1) return invalid_argument("predict: found {} steps, needs at least 1", steps);
    return guarded("predict", [&] { return predict_checked(past, steps); });
  }

  [[nodiscard]] ltm::MeasuredError expected_error(int steps, bool has_conditions) const override {
    return record(has_conditions).expected[index_of(steps)];
  }

 private:
  static size_t index_of(int steps) {
    return static_cast<size_t>(std::clamp(steps, 1, kMeasuredHorizons) - 1);
  }

  [[nodiscard]] const PredictionRecord& record(bool has_conditions) const {
    return has_conditions || !model_->condition ? model_->prediction : model_->unconditioned;
  }

  Result<std::vector<idf::Data>> predict_checked(const ltm::Past& past, int steps) {
    torch::NoGradGuard no_grad;
    const auto history = past.values;
    const auto& layout = model_->plan.layout();
    ENGRAM_ASSIGN_OR_RETURN(const auto split, layout.split(history.back()));
    ENGRAM_ASSIGN_OR_RETURN(const auto earlier,
                            layout.split(history[history.size() > 1 ? history.size() - 2 : 0]));
    ENGRAM_ASSIGN_OR_RETURN(Parts last, model_->to_parts(split));
    ENGRAM_ASSIGN_OR_RETURN(Parts before, model_->to_parts(earlier));
    if (!model_->autoencoder->images.empty())
      last.scene = before.scene = model_->best_scene({&last, 1});
    const bool has_conditions =
        model_->condition && past.conditions.size() == history.size() &&
        add_conditions(past.conditions.back(), last) &&
        add_conditions(past.conditions[history.size() > 1 ? history.size() - 2 : 0], before);
    const auto futures = futures_of(*model_, last, before, steps);
    std::vector<idf::Data> values;
    for (int i = 0; i < steps; ++i) {
      ENGRAM_ASSIGN_OR_RETURN(
          idf::Data value, value_at(history.back(), split, last, futures[static_cast<size_t>(i)], i,
                                    record(has_conditions)));
      values.push_back(std::move(value));
    }
    return values;
  }

  /// False where the condition has another layout now: then it is not known.
  bool add_conditions(const idf::Data& value, Parts& parts) const {
    auto numbers = model_->condition->read(value);
    if (numbers.ok()) parts.conditions = *std::move(numbers);
    return parts.conditions.defined();
  }

  // Members whose gate is closed keep the last value bit for bit.
  Result<idf::Data> value_at(const idf::Data& newest, const idf::SplitValue& split,
                             const Parts& last, const Future& future, int step,
                             const PredictionRecord& record) const {
    const size_t horizon = index_of(step + 1);
    const Shares shares{record.image_gates[horizon], record.motion_gates[horizon],
                        record.number_gates[horizon]};
    const bool copies_images = shares.latents == 0 && shares.motion == 0;
    const bool copies_numbers = shares.numbers == 0;
    if (copies_images && copies_numbers) return newest;
    const Parts mixed = mix(last, future, shares);
    ENGRAM_ASSIGN_OR_RETURN(
        const idf::Data value,
        model_->to_value(model_->to_arrays(mixed), model_->to_numbers(mixed), split.remainder));
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

}  // namespace

std::unique_ptr<ltm::Predictor> make_predictor(std::shared_ptr<DeepModel> model) {
  return std::make_unique<DeepPredictor>(std::move(model));
}

}  // namespace engram::encoders
