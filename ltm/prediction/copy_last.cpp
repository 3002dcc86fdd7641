// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "ltm/prediction/predictor.h"

namespace engram::ltm {

namespace {

class CopyLastPredictor final : public Predictor {
 public:
  [[nodiscard]] std::string_view name() const override { return kCopyLast; }
  [[nodiscard]] Duration step() const override { return Duration(0); }
  [[nodiscard]] size_t context() const override { return 1; }

  Result<std::vector<Prediction>> predict(const Past& past, int steps) override {
    if (past.values.empty()) return invalid_argument("copy-last: needs at least one past value");
    return std::vector<Prediction>(static_cast<size_t>(std::max(steps, 0)),
                                   {past.values.back(), {}, 1, 1});
  }
};

}  // namespace

Result<std::vector<Prediction>> Predictor::predict_at(const Past& past,
                                                      std::span<const int> steps) {
  const int max = std::ranges::max(steps);
  ENGRAM_ASSIGN_OR_RETURN(const auto all, predict(past, max));
  if (all.size() < static_cast<size_t>(max))
    return data_loss("'{}': predicted {} steps, needs {}", name(), all.size(), max);
  std::vector<Prediction> some;
  for (const int step : steps) some.push_back(all[static_cast<size_t>(step) - 1]);
  return some;
}

std::unique_ptr<Predictor> make_copy_last_predictor() {
  return std::make_unique<CopyLastPredictor>();
}

}  // namespace engram::ltm
