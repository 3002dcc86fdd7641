// SPDX-License-Identifier: Apache-2.0
#include "reports/predict_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "reports/coverage_text.h"
#include "reports/plain/members_text.h"
#include "reports/plain/save.h"
#include "reports/plain/text.h"

namespace engram::reports {

namespace {

using ltm::MemoryId;
using ltm::Recall;
using training::PredictedHorizon;
using training::PredictedMoment;
using training::PredictionQuality;

constexpr int kMaxSteps = 1000;

/// Parses a whole number of steps; nothing for any other text.
std::optional<int> steps_from(std::string_view text) {
  int steps = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), steps);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  return is_number && steps >= 1 && steps <= kMaxSteps ? std::optional(steps) : std::nullopt;
}

Status unfitting(const std::string& text) {
  return invalid_argument(
      "horizons '{}': needs steps from 1 to {} as '1..3' or '2', or durations as '+200ms,+400ms'",
      text, kMaxSteps);
}

/// The error that a prediction expects for its first instance.
ltm::MeasuredError expected_of(const ltm::SnapshotResult& predicted) {
  if (predicted.instances.empty()) return {};
  return predicted.instances.front().error.value_or(ltm::MeasuredError{});
}

ltm::MeasuredError bound_of(const ltm::SnapshotResult& predicted) {
  if (predicted.instances.empty()) return {};
  return predicted.instances.front().bound.value_or(ltm::MeasuredError{});
}

std::string bound_name() {
  return fmt::format("{:.0f} % bound", 100 * ltm::kBoundProbability);
}

std::string error_or_dash(const std::optional<ltm::MeasuredError>& error) {
  return error ? error_text(*error) : "-";
}

/// Whether one engine made all predictions.
bool has_one_engine(const PredictedMoment& moment) {
  const ltm::SnapshotResult& first = moment.horizons.front().predicted;
  return std::ranges::all_of(moment.horizons, [&first](const PredictedHorizon& horizon) {
    return horizon.predicted.predictor == first.predictor;
  });
}

Result<Json> horizon_json(const MemoryId& entity, const PredictedHorizon& horizon) {
  Json json{{"horizon_s", to_seconds(horizon.predicted.horizon)},
            {"engine", horizon.predicted.predictor},
            {"expected_error", error_json(expected_of(horizon.predicted))},
            {"error_bound", bound_json(bound_of(horizon.predicted))}};
  if (horizon.actual)
    json["actual"] = {{"id", entity.at(horizon.actual->time).to_string()},
                      {"source", ltm::to_string(horizon.actual->source)}};
  if (horizon.error) json["error"] = error_json(*horizon.error);
  if (const auto is_within = horizon.is_within()) json["within"] = *is_within;
  json["copy_last"] = {{"expected_error", error_json(horizon.copy_told.expected)},
                       {"error_bound", bound_json(horizon.copy_told.bound)}};
  if (horizon.copy_error) json["copy_last"]["error"] = error_json(*horizon.copy_error);
  ENGRAM_ASSIGN_OR_RETURN(json["predicted"], snapshot_json(entity, horizon.predicted));
  return json;
}

/// Calls `add` for each engine with the engine, the conditions that it was given ("known",
/// "planned", "unknown" or "") and its measurements.
template <typename F>
void for_each_record(std::span<const Recall::Engine> engines, F add) {
  for (const Recall::Engine& engine : engines) {
    const bool has_condition = engine.predictor->condition().has_value();
    add(engine, has_condition ? "known" : "",
        engine.predictor->records(ltm::PredictorInputs::kConditions));
    if (!has_condition) continue;
    add(engine, "planned", engine.predictor->records(ltm::PredictorInputs::kPlan));
    add(engine, "unknown", engine.predictor->records(ltm::PredictorInputs::kValues));
  }
}

}  // namespace

Result<std::vector<Duration>> parse_horizons(const std::string& text, Duration step) {
  std::vector<Duration> horizons;
  const auto add_steps = [&](int first, int last) -> Status {
    if (step <= Duration(0))
      return invalid_argument("horizons '{}': a single snapshot has no steps, needs durations",
                              text);
    for (int steps = first; steps <= last; ++steps) horizons.push_back(step * steps);
    return {};
  };
  if (const size_t dots = text.find(".."); dots != std::string::npos) {
    const auto first = steps_from(std::string_view(text).substr(0, dots));
    const auto last = steps_from(std::string_view(text).substr(dots + 2));
    if (!first || !last || *first > *last) return unfitting(text);
    ENGRAM_RETURN_IF_ERROR(add_steps(*first, *last));
    return horizons;
  }
  for (size_t at = 0; at <= text.size();) {
    const size_t end = std::min(text.find(',', at), text.size());
    const std::string_view part = std::string_view(text).substr(at, end - at);
    at = end + 1;
    if (const auto steps = steps_from(part)) {
      ENGRAM_RETURN_IF_ERROR(add_steps(*steps, *steps));
      continue;
    }
    const auto horizon = parse_duration(part.starts_with('+') ? part.substr(1) : part);
    if (!horizon.ok() || *horizon <= Duration(0)) return unfitting(text);
    horizons.push_back(*horizon);
  }
  return horizons;
}

std::string engine_text(const std::string& engine, const std::string& model) {
  const size_t space = model.rfind(' ');
  return engine + (space == std::string::npos ? "" : model.substr(space));  // " v1"
}

std::string moment_text(const MemoryId& entity, const PredictedMoment& moment) {
  const bool is_one = has_one_engine(moment);
  const auto engine_of = [](const ltm::SnapshotResult& predicted) {
    return engine_text(predicted.predictor, predicted.model);
  };
  std::vector<std::string> head{"ahead", "moment", "expected", bound_name(),
                                "real",  "within", "copy-last"};
  if (!is_one) head.insert(head.begin() + 2, "engine");
  TextTable table(head);
  for (const PredictedHorizon& horizon : moment.horizons) {
    const auto is_within = horizon.is_within();
    std::vector<std::string> cells{to_string(horizon.predicted.horizon),
                                   to_string(horizon.predicted.time),
                                   error_text(expected_of(horizon.predicted)),
                                   error_text(bound_of(horizon.predicted)),
                                   error_or_dash(horizon.error),
                                   is_within ? (*is_within ? "yes" : "no") : "-",
                                   error_or_dash(horizon.copy_error)};
    if (!is_one) cells.insert(cells.begin() + 2, engine_of(horizon.predicted));
    table.add(cells);
  }
  const ltm::SnapshotResult& first = moment.horizons.front().predicted;
  std::string text =
      fmt::format("{} from {}, predicted by {}{}\n{}", entity.printable(),
                  to_string(moment.last.time), is_one ? engine_of(first) : "the best engines",
                  first.plan.empty() ? "" : ", told the plan " + first.plan, table.to_string("  "));
  for (const PredictedHorizon& horizon : moment.horizons)
    if (const std::string members = members_text(horizon.predicted); !members.empty())
      text += fmt::format("\n  {} ahead: {}", to_string(horizon.predicted.horizon), members);
  return text;
}

Result<Json> moment_json(const MemoryId& entity, const PredictedMoment& moment) {
  const ltm::SnapshotResult& first = moment.horizons.front().predicted;
  Json json{{"entity", entity.to_string()}, {"engine", first.predictor}};
  if (!first.model.empty()) json["model"] = first.model;
  json["from"] = to_string(moment.last.time);
  json["from_ns"] = to_ns(moment.last.time);
  json["predictions"] = Json::array();
  for (const PredictedHorizon& horizon : moment.horizons) {
    ENGRAM_ASSIGN_OR_RETURN(Json one, horizon_json(entity, horizon));
    json["predictions"].push_back(std::move(one));
  }
  return json;
}

std::string sweep_text(const MemoryId& entity, const std::string& engine,
                       std::span<const Duration> horizons,
                       std::span<const PredictionQuality> qualities) {
  TextTable table({"ahead", "predictions", "mean", "copy-last", "pooled", "copy-last",
                   "within " + bound_name(), "mean bound", "width"});
  for (size_t i = 0; i < horizons.size(); ++i) {
    const auto& [number, model, copy_last, bound_coverage, copy_bound_coverage, moving,
                 moving_copy] = qualities[i];
    if (model.images > 0)
      table.add({to_string(horizons[i]), count_text(model.images), db_text(model.mean_psnr_db),
                 db_text(copy_last.mean_psnr_db), db_text(model.pooled_psnr_db),
                 db_text(copy_last.pooled_psnr_db), within_text(bound_coverage.images),
                 db_text(bound_coverage.images.mean_bound),
                 image_width_text(bound_coverage.images)});
    if (model.numbers > 0)
      table.add({to_string(horizons[i]) + ", RMSE", count_text(model.numbers), "", "",
                 number_text(model.rmse), number_text(copy_last.rmse),
                 within_text(bound_coverage.numbers),
                 number_text(bound_coverage.numbers.mean_bound),
                 number_width_text(bound_coverage.numbers)});
    // Members at rest are predicted well by any engine and would hide the error of those that move,
    // so moments of movement have a row of their own.
    if (moving.numbers > 0 && moving.numbers < model.numbers)
      table.add({to_string(horizons[i]) + ", RMSE of what moves", count_text(moving.numbers), "",
                 "", number_text(moving.rmse), number_text(moving_copy.rmse), "", "", ""});
  }
  return fmt::format("{}, predicted by {}\n{}", entity.printable(),
                     engine.empty() ? "the best engine of each moment" : engine,
                     table.to_string("  "));
}

Json sweep_json(const MemoryId& entity, const std::string& engine,
                std::span<const Duration> horizons, std::span<const PredictionQuality> qualities) {
  Json json{{"entity", entity.to_string()}, {"engine", engine.empty() ? "best" : engine}};
  json["horizons"] = Json::array();
  for (size_t i = 0; i < horizons.size(); ++i) {
    Json one = training::to_json(qualities[i]);
    one["horizon_s"] = to_seconds(horizons[i]);
    json["horizons"].push_back(std::move(one));
  }
  return json;
}

std::string engines_text(const MemoryId& entity, Duration step,
                         std::span<const EnginesAhead> measured,
                         std::span<const Recall::Engine> models) {
  TextTable table({"engine", "ahead", "measured predictions", "error", bound_name(), ""});
  for (const EnginesAhead& one : measured)
    for (const ltm::EngineRecord& record : one.records)
      table.add({engine_text(record.engine, record.model), to_string(one.ahead),
                 count_text(record.predictions), error_text(record.mean), error_text(record.bound),
                 &record == &one.records.front() ? "answers" : ""});
  std::string text = fmt::format("{}, steps of {}, measured on its own past\n{}",
                                 entity.printable(), to_string(step), table.to_string("  "));
  TextTable told({"engine", "conditions", "ahead", "measured predictions", "error"});
  bool is_any = false;
  for_each_record(models, [&](const Recall::Engine& engine, const char* conditions,
                              const std::vector<ltm::HorizonRecord>& records) {
    for (const ltm::HorizonRecord& record : records) {
      told.add({engine_text(std::string(engine.predictor->name()), engine.model), conditions,
                to_string(step * record.steps), count_text(record.predictions),
                error_text(record.mean)});
      is_any = true;
    }
  });
  if (is_any)
    text += fmt::format("\n\nas its model tells, measured when it was trained\n{}",
                        told.to_string("  "));
  return text;
}

Json engines_json(const MemoryId& entity, Duration step, std::span<const EnginesAhead> measured,
                  std::span<const Recall::Engine> models) {
  Json json{{"entity", entity.to_string()}, {"step_s", to_seconds(step)}};
  json["horizons"] = Json::array();
  for (const EnginesAhead& one : measured) {
    Json horizon{{"horizon_s", to_seconds(one.ahead)},
                 {"answers", one.records.empty() ? "" : one.records.front().engine}};
    horizon["engines"] = Json::array();
    for (const ltm::EngineRecord& record : one.records) {
      Json engine{{"engine", record.engine}};
      if (!record.model.empty()) engine["model"] = record.model;
      engine["measured_predictions"] = record.predictions;
      engine["mean_error"] = error_json(record.mean);
      engine["error_bound"] = bound_json(record.bound);
      horizon["engines"].push_back(std::move(engine));
    }
    json["horizons"].push_back(std::move(horizon));
  }
  json["models"] = Json::array();
  for_each_record(models, [&](const Recall::Engine& engine, const std::string& conditions,
                              const std::vector<ltm::HorizonRecord>& records) {
    if (records.empty()) return;
    Json one{{"engine", std::string(engine.predictor->name())}};
    if (!engine.model.empty()) one["model"] = engine.model;
    if (!conditions.empty()) {
      one["condition"] = engine.predictor->condition()->to_string();
      one["is_condition_known"] = conditions != "unknown";
      one["is_condition_planned"] = conditions == "planned";
    }
    one["horizons"] = Json::array();
    for (const ltm::HorizonRecord& record : records)
      one["horizons"].push_back({{"steps", record.steps},
                                 {"measured_predictions", record.predictions},
                                 {"mean_error", error_json(record.mean)}});
    json["models"].push_back(std::move(one));
  });
  return json;
}

}  // namespace engram::reports
