// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "ltm/redaction/detector.h"

namespace engram::ltm {

/// Finds objects with a network in an ONNX file, which OpenCV evaluates.
///
/// Shape: it gets float32 [1, 3, size, size], RGB in 0..1; the image lies in the upper left corner
/// and keeps its proportions, the rest is 0.5. It gives one output of either layout:
///   [1, 4 + classes, N]  centre x, centre y, width, height in pixels of the input, then a score
///                        for each class (YOLO from version 8 on); N is above 4 + classes
///   [1, 1, N, 7]         image, class, score, left, top, right, bottom, in 0..1 of the input
///                        (SSD); an image below 0 ends the list
/// Scores are 0 to 1. An output with a score that is not, or is no number, is no answer.
/// Threading: thread-safe; one image after the other.
class OnnxDetector final : public Detector {
 public:
  struct Options {
    std::filesystem::path file;
    /// Boxes of a lower score are left out. 0..1; lower ones find more, and more that is none.
    double threshold = 0.25;
    std::vector<int> classes;  ///< Classes that count; empty: all.
    int size = 640;            ///< The side of its input; the time grows with its square.

    [[nodiscard]] Status validate() const;
    friend bool operator==(const Options&, const Options&) = default;
  };

  /// Errors: kInvalidArgument; kNotFound if there is no such file; kFailedPrecondition if it cannot
  /// be loaded, or gives something else for a black image: another layout, more than one output,
  /// other scores, boxes in parts of the input instead of pixels.
  static Result<std::unique_ptr<Detector>> create(const Options& options);
  ~OnnxDetector() override;

  [[nodiscard]] std::string_view name() const override { return "onnx"; }
  Result<std::vector<Box>> find(const DetectorImage& image) override;

 private:
  struct State;
  explicit OnnxDetector(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
