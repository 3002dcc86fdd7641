// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <variant>

#include "ltm/redaction/faces_detector.h"
#include "ltm/redaction/onnx_detector.h"
#include "ltm/redaction/people_detector.h"
#include "ltm/redaction/program_detector.h"

namespace engram::ltm {

/// The options of one detector of any kind.
using DetectorOptions = std::variant<PeopleDetector::Options, FacesDetector::Options,
                                     ProgramDetector::Options, OnnxDetector::Options>;

/// The names of all detectors, in the order of DetectorOptions.
[[nodiscard]] std::span<const std::string_view> all_detectors();

/// Makes a detector of the kind that the options are of. Programs are started and files loaded.
/// Errors: those of the detector's create.
Result<std::unique_ptr<Detector>> make_detector(const DetectorOptions& options);

[[nodiscard]] Status validate(const DetectorOptions& options);

}  // namespace engram::ltm
