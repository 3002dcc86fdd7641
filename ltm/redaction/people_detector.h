// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "ltm/redaction/detector.h"

namespace engram::ltm {

/// Finds standing people by OpenCV's histograms of oriented gradients and the support vector
/// machine that comes with it. Best effort: who sits, lies or is cut off by the image is mostly
/// missed.
///
/// Threading: immutable, const-parallel.
/// Source: Dalal and Triggs, Histograms of Oriented Gradients for Human Detection, 2005.
class PeopleDetector final : public Detector {
 public:
  struct Options {
    [[nodiscard]] Status validate() const { return {}; }
    friend bool operator==(const Options&, const Options&) = default;
  };

  static Result<std::unique_ptr<Detector>> create(const Options& options);
  ~PeopleDetector() override;

  [[nodiscard]] std::string_view name() const override { return "people"; }
  Result<std::vector<Box>> find(const DetectorImage& image) override;

 private:
  struct State;
  explicit PeopleDetector(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
