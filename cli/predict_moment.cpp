// SPDX-License-Identifier: Apache-2.0
// Predictions from one moment, of a store and of a server alike: both are a Memory.
#include <algorithm>

#include "cli/predict_options.h"
#include "reports/plain/result_text.h"
#include "reports/plain/save.h"
#include "reports/predict_picture.h"
#include "reports/predict_text.h"

namespace engram::cli {

namespace {

training::PredictionSource source_of(Memory& memory, const ltm::MemoryId& entity) {
  return {[&memory, entity](const ltm::PredictionRequest& request) {
            return memory.predict(entity, request.horizons,
                                  PredictOptions{request.from, request.plan, request.engine});
          },
          [&memory](const ltm::Query& query) { return memory.query(query); }};
}

Status save(const ltm::MemoryId& entity, const training::PredictedMoment& moment,
            const PredictArguments& arguments) {
  size_t count = 0;
  for (const training::PredictedHorizon& horizon : moment.horizons) {
    ENGRAM_ASSIGN_OR_RETURN(const auto files,
                            reports::save_snapshot(entity, horizon.predicted, arguments.save));
    count += files.size();
  }
  if (!arguments.is_json) print(fmt::format("{} files written below {}", count, arguments.save));
  return {};
}

Status predict(const training::PredictionSource& source, const ltm::MemoryId& entity,
               ltm::PredictionRequest request, Duration step, const PredictArguments& arguments) {
  if (arguments.is_compared && !request.from) {
    // Starts early enough that the snapshots of all horizons are known.
    ENGRAM_ASSIGN_OR_RETURN(request.from, training::last_known_from(
                                              source, entity, std::ranges::max(request.horizons)));
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto moment,
                          training::predict_moment(source, entity, request, step));
  if (arguments.is_compared && std::ranges::none_of(moment.horizons, [](const auto& horizon) {
        return horizon.error.has_value();
      }))
    return not_found("entity '{}': nothing is known of what came after {}, needs it to compare",
                     entity.to_string(), to_string(moment.last.time));
  if (request.plan && moment.horizons.front().predicted.plan.empty())
    return not_found("entity '{}': nothing is planned after {}", request.plan->to_string(),
                     to_string(moment.last.time));
  ENGRAM_ASSIGN_OR_RETURN(const Json json, reports::moment_json(entity, moment));
  show(arguments, reports::moment_text(entity, moment), json);
  if (!arguments.save.empty()) ENGRAM_RETURN_IF_ERROR(save(entity, moment, arguments));
  if (!arguments.picture.empty())
    ENGRAM_RETURN_IF_ERROR(reports::write_predict_picture(moment, arguments.picture));
  return {};
}

Status list(Memory& memory, const ltm::MemoryId& entity, Duration step,
            std::span<const Duration> horizons, const PredictArguments& arguments) {
  std::vector<reports::EnginesAhead> measured;
  for (const Duration horizon : horizons) {
    ENGRAM_ASSIGN_OR_RETURN(auto records, memory.engines(entity, horizon, time_of(arguments.at)));
    measured.push_back({horizon, std::move(records)});
  }
  show(arguments, reports::engines_text(entity, step, measured, {}),
       reports::engines_json(entity, step, measured, {}));
  return {};
}

}  // namespace

ExitCode predict_moment(const PredictArguments& arguments, const ltm::MemoryId& entity) {
  const auto memory =
      open_memory(arguments.store, {.is_read_only = true, .notes_reads = false}, arguments.remote);
  if (!memory.ok()) return fail(memory.status());
  const training::PredictionSource source = source_of(**memory, entity);
  const auto step = training::step_of(source, entity);
  if (!step.ok()) return fail(step.status());
  const auto horizons = reports::parse_horizons(horizons_text(arguments, *step), *step);
  if (!horizons.ok()) return wrong_usage(horizons.status());
  if (arguments.is_list) return done_or_failed(list(**memory, entity, *step, *horizons, arguments));
  ltm::PredictionRequest request{time_of(arguments.at), *horizons, arguments.engine};
  if (!arguments.plan.empty()) request.plan = *ltm::MemoryId::parse(arguments.plan);
  return done_or_failed(predict(source, entity, std::move(request), *step, arguments));
}

}  // namespace engram::cli
