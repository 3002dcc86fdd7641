// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/predict_options.h"
#include "cli/progress_line.h"
#include "ltm/prediction/entity_predictor.h"
#include "memory/model_loader.h"
#include "reports/predict_text.h"

namespace engram::cli {

namespace {

constexpr const char* kPredictFooter =
    R"(Predicts what comes after a moment from the snapshots up to it alone: no later ones, and no later
numbers of an entity that it links to. For each horizon the engine answers that was best on the
entity's own past: its model, where it has one, straight lines, an autoregression or the last value
(--list shows them, --engine names one). Every prediction tells the error to expect and a bound that
its real error keeps with a probability of 90 %.
Where the store knows what really came, it stands beside: errors of the prediction and of a copy of
the last snapshot, and whether the bound held. Images: PSNR (a bound is the least), numbers: RMSE.
With --plan predictions are told where the robot's joints are going to be, from an entity of the
store that has values after that moment, and say so.

Examples:
  engram predict robot.engram Vision/RGB/head/cam
  engram predict robot.engram Vision/RGB/head/cam --compare --picture predict.png
  engram predict robot.engram Vision/RGB/head/cam --at '2022-02-18 13:00:20' --horizons +200ms,+1s
  engram predict robot.engram RobotState/Proprioception/robot/joints --compare --json
  engram predict robot.engram Vision/RGB/head/cam --every 10
  engram predict robot.engram Vision/RGB/head/cam --plan RobotState/Planning/arm/joints
  engram predict robot.engram RobotState/Proprioception/robot/joints --horizons +1s --engine line
  engram predict robot.engram RobotState/Proprioception/robot/joints --list --horizons 200ms,400ms,1s
  engram predict robot.engram Vision/RGB/head/cam --list --json
  engram predict --server 127.0.0.1:50051 Vision/RGB/head/cam --horizons +200ms,+400ms
  engram predict Vision/RGB/head/cam --at '2022-02-18 13:00:20' --compare)";

Status list(ltm::Recall& recall, const ltm::MemoryId& entity, Duration step,
            std::span<const Duration> horizons, const PredictArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const auto models, recall.engines(entity));
  std::vector<reports::EnginesAhead> measured;
  for (const Duration ahead : horizons) {
    ENGRAM_ASSIGN_OR_RETURN(auto records, recall.records(entity, time_of(arguments.at), ahead, {}));
    measured.push_back({ahead, std::move(records)});
  }
  show(arguments, reports::engines_text(entity, step, measured, models),
       reports::engines_json(entity, step, measured, models));
  return {};
}

Status sweep(ltm::Recall& recall, const ltm::MemoryId& entity,
             const ltm::Recall::PredictionRequest& request, const PredictArguments& arguments) {
  const training::SweepOptions options{time_of(arguments.from), time_of(arguments.to),
                                       std::max<size_t>(arguments.every, 1)};
  ProgressLine progress;
  const auto qualities =
      training::sweep(recall, entity, request, options, progress.sink(), interrupt_token());
  progress.finish();
  ENGRAM_RETURN_IF_ERROR(qualities.status());
  show(arguments, reports::sweep_text(entity, arguments.engine, request.horizons, *qualities),
       reports::sweep_json(entity, arguments.engine, request.horizons, *qualities));
  return {};
}

/// Returns the step of the named engine, else that of the entity's model.
Result<Duration> step_of(ltm::Recall& recall, const ltm::MemoryId& entity,
                         const std::string& engine) {
  ENGRAM_ASSIGN_OR_RETURN(const auto models, recall.engines(entity));
  const auto named = std::ranges::find(models, engine, [](const ltm::Recall::Engine& model) {
    return std::string(model.predictor->name());
  });
  return training::step_of(recall, entity, named != models.end() ? *named : models.front());
}

/// Lists the engines of an entity of a store, or measures predictions from many moments: both need
/// the store itself.
ExitCode measure(const PredictArguments& arguments, const ltm::MemoryId& entity) {
  auto reader = ltm::StoreReader::open(arguments.store);
  if (!reader.ok()) return fail(reader.status());
  ltm::Recall recall(std::move(*reader), model_loader(), nullptr, ltm::make_entity_predictor);
  const auto step = step_of(recall, entity, arguments.engine);
  if (!step.ok()) return fail(step.status());
  const auto horizons = reports::parse_horizons(horizons_text(arguments, *step), *step);
  if (!horizons.ok()) return wrong_usage(horizons.status());
  if (arguments.is_list) return done_or_failed(list(recall, entity, *step, *horizons, arguments));
  ltm::Recall::PredictionRequest request{{}, *horizons, arguments.engine};
  if (!arguments.plan.empty()) request.plan = *ltm::MemoryId::parse(arguments.plan);
  return done_or_failed(sweep(recall, entity, request, arguments));
}

/// Checks which options go together.
Status check(const PredictArguments& arguments, bool is_sweep) {
  const bool is_moment = !arguments.at.empty() || arguments.is_compared ||
                         !arguments.picture.empty() || !arguments.save.empty();
  if (is_sweep && is_moment)
    return invalid_argument(
        "--every, --from and --to are of many moments: --at, --compare, --picture and --save of "
        "one");
  if (!arguments.store.empty()) return {};
  if (is_sweep)
    return invalid_argument("--every, --from and --to are of stores, and found a server");
  return {};
}

ExitCode run(PredictArguments arguments) {
  // A single argument names the entity at a server.
  if (arguments.entity.empty()) std::swap(arguments.store, arguments.entity);
  if (arguments.entity.empty()) return wrong_usage(invalid_argument("entity is required"));
  if (const std::string wrong = entity_text()(arguments.entity); !wrong.empty())
    return wrong_usage(invalid_argument("entity: {}", wrong));
  if (const Status named = check_source(arguments.store, arguments.remote); !named.ok())
    return wrong_usage(named);
  const bool is_sweep = arguments.every > 0 || !arguments.from.empty() || !arguments.to.empty();
  if (const Status fits = check(arguments, is_sweep); !fits.ok()) return wrong_usage(fits);
  const ltm::MemoryId entity = *ltm::MemoryId::parse(arguments.entity);
  const bool needs_store = is_sweep || (arguments.is_list && !arguments.store.empty());
  return needs_store ? measure(arguments, entity) : predict_moment(arguments, entity);
}

}  // namespace

void add_predict_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<PredictArguments>();
  CLI::App* command =
      app.add_subcommand("predict", "Predict from any moment, and compare with what came");
  command->footer(kPredictFooter);
  add_predict_options(*command, *arguments);
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
