// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/predictor.h"

namespace engram::ltm {

namespace {

class CopyLastPredictor final : public Predictor {
 public:
  [[nodiscard]] std::string_view name() const override { return "copy-last"; }
  [[nodiscard]] Duration step() const override { return Duration(0); }
  [[nodiscard]] size_t context() const override { return 1; }

  Result<std::vector<Prediction>> predict(const Past& past, int steps) override {
    if (past.values.empty()) return invalid_argument("copy-last: needs at least one past value");
    return std::vector<Prediction>(static_cast<size_t>(std::max(steps, 0)),
                                   {past.values.back(), {}});
  }
};

}  // namespace

std::unique_ptr<Predictor> make_copy_last_predictor() {
  return std::make_unique<CopyLastPredictor>();
}

}  // namespace engram::ltm
