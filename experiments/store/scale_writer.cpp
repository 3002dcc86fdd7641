// SPDX-License-Identifier: Apache-2.0
#include "store/scale_writer.h"

#include <vector>

#include "ltm/recording/recording_config.h"
#include "store/report.h"
#include "store/store_measure.h"

namespace engram::experiments {

namespace {

bool is_late(uint64_t step) {
  return step % ScaleWorld::kOneLateOf == ScaleWorld::kOneLateOf / 2;
}

/// Calls `visit` once for every step, in order except for late steps.
template <typename Visit>
Status visit_steps(uint64_t steps, const Visit& visit) {
  for (uint64_t now = 0; now < steps + ScaleWorld::kLateBy; ++now) {
    if (now < steps && !is_late(now)) ENGRAM_RETURN_IF_ERROR(visit(now));
    if (now >= ScaleWorld::kLateBy && is_late(now - ScaleWorld::kLateBy))
      ENGRAM_RETURN_IF_ERROR(visit(now - ScaleWorld::kLateBy));
  }
  return {};
}

}  // namespace

Result<nlohmann::json> write_scale(const ScaleWorld& world, const std::filesystem::path& store) {
  ENGRAM_RETURN_IF_ERROR(make_empty(store));
  ENGRAM_ASSIGN_OR_RETURN(const auto options,
                          ltm::parse_recording_config("preset: recorder\n", "recorder"));
  std::vector<double> latencies;
  latencies.reserve(world.steps);
  double close_s = 0;
  const Stopwatch clock;
  ENGRAM_ASSIGN_OR_RETURN(ltm::Recorder recorder, ltm::Recorder::open(store, options));
  ENGRAM_RETURN_IF_ERROR(visit_steps(world.steps, [&](uint64_t step) {
    const ltm::Commit commit = world.commit(step);
    const Stopwatch one;
    Status status = recorder.commit(commit);
    latencies.push_back(one.seconds());
    return status;
  }));
  const Stopwatch closing;
  ENGRAM_RETURN_IF_ERROR(recorder.close());
  close_s = closing.seconds();
  const double seconds = clock.seconds();
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t bytes, tree_bytes(store));
  ENGRAM_ASSIGN_OR_RETURN(const Memory peak, memory());
  return nlohmann::json{{"seconds", seconds},
                        {"close_seconds", close_s},
                        {"bytes", bytes},
                        {"memory_bytes", peak.peak_bytes},
                        {"commit", to_json(summarize(latencies))}};
}

}  // namespace engram::experiments
