// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "cli/predict_options.h"
#include "reports/plain/result_text.h"
#include "reports/predict_text.h"

namespace engram::cli {

namespace {

/// The median step between the newest snapshots of the server.
Result<Duration> step_at_server(Memory& memory, const ltm::MemoryId& entity) {
  constexpr int64_t kSnapshots = 21;
  const auto result = memory.query(ltm::Query::of_entity(entity, ltm::select::Latest{kSnapshots}));
  ENGRAM_RETURN_IF_ERROR(result.status());
  std::vector<Duration> steps;
  const ltm::EntityResult* found = result->find_entity(entity);
  for (size_t i = 1; found != nullptr && i < found->snapshots.size(); ++i)
    steps.push_back(found->snapshots[i].time - found->snapshots[i - 1].time);
  if (steps.empty())
    return not_found("entity '{}' has too few snapshots to know its step: needs --horizons +200ms",
                     entity.to_string());
  const auto middle = steps.begin() + static_cast<ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return *middle;
}

}  // namespace

ExitCode predict_at_server(const PredictArguments& arguments, const ltm::MemoryId& entity) {
  const auto memory = connect_memory(arguments.remote);
  if (!memory.ok()) return fail(memory.status());
  Duration step{};
  if (arguments.is_list || arguments.horizons.find('+') == std::string::npos) {
    const auto known = step_at_server(**memory, entity);
    if (!known.ok()) return fail(known.status());
    step = *known;
  }
  const auto horizons = reports::parse_horizons(horizons_text(arguments, step), step);
  if (!horizons.ok()) return wrong_usage(horizons.status());
  if (arguments.is_list) {
    std::vector<reports::EnginesAhead> measured;
    for (const Duration horizon : *horizons) {
      auto records = (*memory)->engines(entity, horizon);
      if (!records.ok()) return fail(records.status());
      measured.push_back({horizon, *std::move(records)});
    }
    show(arguments, reports::engines_text(entity, step, measured, {}),
         reports::engines_json(entity, step, measured, {}));
    return ExitCode::kDone;
  }
  ltm::QueryResult all;
  for (const Duration horizon : *horizons) {
    auto result = (*memory)->query(ltm::Query::of_entity(entity, ltm::select::Ahead{horizon}),
                                   arguments.engine);
    if (!result.ok()) return fail(result.status());
    if (const Status merged = all.merge(*std::move(result)); !merged.ok()) return fail(merged);
  }
  return done_or_failed(reports::show_result(all, arguments.save, arguments.is_json));
}

}  // namespace engram::cli
