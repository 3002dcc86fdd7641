// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/detector_registry.h"

#include <array>

namespace engram::ltm {

namespace {

struct DetectorMaker {
  using Made = Result<std::unique_ptr<Detector>>;
  Made operator()(const PeopleDetector::Options& options) {
    return PeopleDetector::create(options);
  }
  Made operator()(const FacesDetector::Options& options) { return FacesDetector::create(options); }
  Made operator()(const ProgramDetector::Options& options) {
    return ProgramDetector::create(options);
  }
  Made operator()(const OnnxDetector::Options& options) { return OnnxDetector::create(options); }
};

}  // namespace

std::span<const std::string_view> all_detectors() {
  static constexpr std::array<std::string_view, std::variant_size_v<DetectorOptions>> kNames{
      "people", "faces", "program", "onnx"};
  return kNames;
}

Result<std::unique_ptr<Detector>> make_detector(const DetectorOptions& options) {
  ENGRAM_RETURN_IF_ERROR(validate(options));
  return std::visit(DetectorMaker(), options);
}

Status validate(const DetectorOptions& options) {
  return std::visit([](const auto& each) { return each.validate(); }, options);
}

}  // namespace engram::ltm
