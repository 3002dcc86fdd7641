// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "reports/plain/output.h"
#include "training/measure/predicted_moment.h"

namespace engram::reports {

/// Parses horizons: "1..3" and "2" count steps, "+200ms,+400ms" are durations.
/// Errors: kInvalidArgument naming the text and what is needed.
Result<std::vector<Duration>> parse_horizons(const std::string& text, Duration step);

/// Such as "deep v1" or "copy-last".
[[nodiscard]] std::string engine_text(const std::string& engine, const std::string& model);

/// Formats predictions of one moment as a table of expected and actual errors.
[[nodiscard]] std::string moment_text(const ltm::MemoryId& entity,
                                      const training::PredictedMoment& moment);
/// Like moment_text(), with the predicted data.
/// Errors: those of idf::to_json.
Result<Json> moment_json(const ltm::MemoryId& entity, const training::PredictedMoment& moment);

/// Formats the means over many moments. `horizons` and `qualities` have the same length; an empty
/// `engine` means the best one for each moment.
[[nodiscard]] std::string sweep_text(const ltm::MemoryId& entity, const std::string& engine,
                                     std::span<const Duration> horizons,
                                     std::span<const training::PredictionQuality> qualities);
[[nodiscard]] Json sweep_json(const ltm::MemoryId& entity, const std::string& engine,
                              std::span<const Duration> horizons,
                              std::span<const training::PredictionQuality> qualities);

/// The measured errors of an entity's engines on its past at one horizon. The first engine is the
/// one that answers.
struct EnginesAhead {
  Duration ahead{};
  std::vector<ltm::EngineRecord> records;
};

/// Formats all engines that can predict an entity: measured on its own past, and as its models
/// recorded them in training.
[[nodiscard]] std::string engines_text(const ltm::MemoryId& entity, Duration step,
                                       std::span<const EnginesAhead> measured,
                                       std::span<const ltm::Recall::Engine> models);
[[nodiscard]] Json engines_json(const ltm::MemoryId& entity, Duration step,
                                std::span<const EnginesAhead> measured,
                                std::span<const ltm::Recall::Engine> models);

}  // namespace engram::reports
