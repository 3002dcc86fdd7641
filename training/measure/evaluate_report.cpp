// SPDX-License-Identifier: Apache-2.0
#include "training/measure/evaluate_report.h"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "training/measure/quality_json.h"

namespace engram::training {

namespace {

nlohmann::ordered_json prediction_json(const EntityEvaluation& entity) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (size_t kind = 0; kind < kKnownKinds; ++kind) {
    auto& list = json[std::string(to_string(static_cast<Known>(kind)))];
    list = nlohmann::ordered_json::array();
    for (const PredictionQuality& prediction : entity.prediction[kind])
      list.push_back(to_json(prediction));
  }
  return json;
}

nlohmann::ordered_json code_json(const CodeLength& code) {
  return {{"rows", code.rows},
          {"later_rows", code.later_rows},
          {"coded_bytes", code.coded_bytes},
          {"ideal_bytes", number_json(code.ideal_bytes)},
          {"later_bytes", number_json(code.later_bytes)},
          {"prior_row_bytes", number_json(code.prior_row_bytes)}};
}

}  // namespace

std::string_view to_string(Known known) {
  switch (known) {
    case Known::kTrained:
      return "trained on";
    case Known::kHeldOut:
      return "held out";
    case Known::kLeftOutRecording:
      return "left-out recordings";
  }
  return "unknown";
}

nlohmann::ordered_json to_json(const PredictionQuality& prediction) {
  return {{"horizon", prediction.horizon},
          {"model", quality_json(prediction.model)},
          {"copy_last", quality_json(prediction.copy_last)},
          {"model_bound", bound_coverage_json(prediction.model_bound_coverage)},
          {"copy_last_bound", bound_coverage_json(prediction.copy_bound_coverage)}};
}

nlohmann::ordered_json to_json(const EvalReport& report) {
  nlohmann::ordered_json entities = nlohmann::ordered_json::array();
  for (const EntityEvaluation& entity : report.entities)
    entities.push_back({{"entity", entity.entity.to_string()},
                        {"model_version", entity.model_version},
                        {"snapshots", entity.snapshots},
                        {"not_evaluated", entity.not_evaluated},
                        {"reconstruction", quality_json(entity.reconstruction)},
                        {"left_out_reconstruction", quality_json(entity.left_out_reconstruction)},
                        {"prediction", prediction_json(entity)},
                        {"in_order_ms", number_json(entity.access.in_order_ms)},
                        {"scattered_ms", number_json(entity.access.scattered_ms)},
                        {"scattered_p99_ms", number_json(entity.access.scattered_p99_ms)},
                        {"code", code_json(entity.code)},
                        {"raw_bytes", entity.raw_bytes},
                        {"stored_bytes", entity.stored_bytes},
                        {"latent_bytes", entity.latent_bytes},
                        {"model_bytes", entity.model_bytes}});
  return {{"entities", std::move(entities)}};
}

}  // namespace engram::training
