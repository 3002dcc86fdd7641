// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/redaction_config.h"

#include <array>

#include "ltm/filter/config_choice.h"

namespace engram::ltm {

namespace {

constexpr const char* kDetectorForms =
    "needs people, faces, {faces: FILE}, {program: [PROGRAM, ARGUMENT, ...]} or {onnx: FILE}";

Result<DetectorOptions> read_named_detector(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string name, value.text());
  if (name == "people") return DetectorOptions(PeopleDetector::Options());
  if (name == "faces") return DetectorOptions(FacesDetector::Options());
  return value.error(fmt::format("found detector '{}', {}", name, kDetectorForms));
}

Result<DetectorOptions> read_program(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(const auto words, value.list());
  ProgramDetector::Options options;
  for (const ConfigValue& word : words) {
    ENGRAM_ASSIGN_OR_RETURN(options.command.emplace_back(), word.text());
  }
  if (const Status status = options.validate(); !status.ok()) return value.error(status);
  return DetectorOptions(std::move(options));
}

Result<DetectorOptions> read_onnx(ConfigMap& map, const ConfigValue& file) {
  OnnxDetector::Options options;
  ENGRAM_ASSIGN_OR_RETURN(options.file, file.text());
  ENGRAM_RETURN_IF_ERROR(map.read("threshold", options.threshold, &ConfigValue::number));
  int64_t size = options.size;
  ENGRAM_RETURN_IF_ERROR(map.read("size", size, &ConfigValue::integer));
  options.size = static_cast<int>(std::clamp<int64_t>(size, 0, INT32_MAX));
  if (const auto classes = map.find("classes")) {
    ENGRAM_ASSIGN_OR_RETURN(const auto numbers, classes->list());
    for (const ConfigValue& number : numbers) {
      ENGRAM_ASSIGN_OR_RETURN(const int64_t one, number.integer());
      if (one < 0 || one > INT32_MAX) return number.error("needs the number of a class, from 0 on");
      options.classes.push_back(static_cast<int>(one));
    }
  }
  if (const Status status = options.validate(); !status.ok()) return map.value().error(status);
  return DetectorOptions(std::move(options));
}

Result<DetectorOptions> read_detector(const ConfigValue& value) {
  if (value.is_text()) return read_named_detector(value);
  if (!value.is_map()) return value.error(kDetectorForms);
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  const auto program = map.find("program");
  const auto onnx = map.find("onnx");
  const auto faces = map.find("faces");
  if ((program ? 1 : 0) + (onnx ? 1 : 0) + (faces ? 1 : 0) != 1) return value.error(kDetectorForms);
  DetectorOptions options;
  if (program) {
    ENGRAM_ASSIGN_OR_RETURN(options, read_program(*program));
  } else if (onnx) {
    ENGRAM_ASSIGN_OR_RETURN(options, read_onnx(map, *onnx));
  } else {
    FacesDetector::Options of_faces;
    ENGRAM_ASSIGN_OR_RETURN(of_faces.cascade, faces->text());
    options = std::move(of_faces);
  }
  ENGRAM_RETURN_IF_ERROR(map.finish());
  return options;
}

}  // namespace

Result<RedactionOptions> read_redaction(const ConfigValue& value) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, value.map());
  RedactionOptions options;
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue detector, map.require("detector"));
  ENGRAM_ASSIGN_OR_RETURN(options.detector, read_detector(detector));
  ENGRAM_RETURN_IF_ERROR(
      read_choice(map, "action", options.action,
                  std::array<Choice<RedactAction>, 3>{{{"pixelate", RedactAction::kPixelate},
                                                       {"fill", RedactAction::kFill},
                                                       {"drop", RedactAction::kDrop}}}));
  ENGRAM_RETURN_IF_ERROR(map.read("grow", options.grow, &ConfigValue::number));
  ENGRAM_RETURN_IF_ERROR(map.read("hold", options.hold, &ConfigValue::duration));
  if (const auto timeout = map.find("timeout")) {
    auto* const program = std::get_if<ProgramDetector::Options>(&options.detector);
    if (program == nullptr) return timeout->error("is for programs, found another detector");
    ENGRAM_ASSIGN_OR_RETURN(program->timeout, timeout->duration());
  }
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (const Status status = options.validate(); !status.ok()) return value.error(status);
  return options;
}

Result<DetectorOptions> parse_detector(std::string_view text, const std::string& name) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue value, ConfigValue::parse(text, name));
  return read_detector(value);
}

}  // namespace engram::ltm
