// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "ltm/redaction/detector.h"

namespace engram::ltm {

/// Finds faces that look at the camera by a cascade of Haar features. Best effort: faces from the
/// side, from above or of some 20 pixels are missed.
///
/// Threading: thread-safe; one image after the other.
/// Source: Viola and Jones, Rapid Object Detection using a Boosted Cascade of Simple Features,
/// 2001.
class FacesDetector final : public Detector {
 public:
  struct Options {
    /// The cascade; empty: that of Debian's package opencv-data for faces from the front.
    std::filesystem::path cascade;

    [[nodiscard]] Status validate() const { return {}; }
    friend bool operator==(const Options&, const Options&) = default;
  };

  /// Errors: kNotFound if there is no such file; kInvalidArgument if it holds no cascade.
  static Result<std::unique_ptr<Detector>> create(const Options& options);
  ~FacesDetector() override;

  [[nodiscard]] std::string_view name() const override { return "faces"; }
  Result<std::vector<Box>> find(const DetectorImage& image) override;

 private:
  struct State;
  explicit FacesDetector(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
