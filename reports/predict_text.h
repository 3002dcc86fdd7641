// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "reports/plain/output.h"
#include "training/measure/predicted_moment.h"

namespace engram::reports {

/// Reads "1..3" and "2", in steps, or "+200ms,+400ms".
/// Errors: kInvalidArgument naming the text and what is needed.
Result<std::vector<Duration>> parse_horizons(const std::string& text, Duration step);

/// "deep v1", "copy-last".
[[nodiscard]] std::string engine_text(const std::string& engine, const std::string& model);

/// Predictions of one moment as a table: what was expected, and what came.
[[nodiscard]] std::string moment_text(const ltm::MemoryId& entity,
                                      const training::PredictedMoment& moment);
/// The same, with the predicted data. Errors: those of idf::to_json.
Result<Json> moment_json(const ltm::MemoryId& entity, const training::PredictedMoment& moment);

/// The means of many moments. `horizons` are as many as `qualities`; `engine` may be empty: the
/// best for each.
[[nodiscard]] std::string sweep_text(const ltm::MemoryId& entity, const std::string& engine,
                                     std::span<const Duration> horizons,
                                     std::span<const training::PredictionQuality> qualities);
[[nodiscard]] Json sweep_json(const ltm::MemoryId& entity, const std::string& engine,
                              std::span<const Duration> horizons,
                              std::span<const training::PredictionQuality> qualities);

/// What engines of an entity were worth on its past, one horizon ahead; the first one answers.
struct EnginesAhead {
  Duration ahead{};
  std::vector<ltm::EngineRecord> records;
};

/// Everything that can predict an entity: measured on its own past, and what its model tells.
[[nodiscard]] std::string engines_text(const ltm::MemoryId& entity, Duration step,
                                       std::span<const EnginesAhead> measured,
                                       std::span<const ltm::Recall::Engine> models);
[[nodiscard]] Json engines_json(const ltm::MemoryId& entity, Duration step,
                                std::span<const EnginesAhead> measured,
                                std::span<const ltm::Recall::Engine> models);

}  // namespace engram::reports
