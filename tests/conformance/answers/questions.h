// SPDX-License-Identifier: Apache-2.0
// What a memory is asked in the suite of answers: questions about every entity of the lived store.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ltm/recall/recall.h"

namespace engram::testing {

/// Queries of the past and the future, of one entity and of several, whole and of IDs alone.
std::vector<std::string> questions();

/// A question about the future of an earlier moment, or with a plan.
struct FutureQuestion {
  std::string entity;
  ltm::PredictionRequest request;

  [[nodiscard]] std::string text() const;
};
std::vector<FutureQuestion> future_questions();

/// A question about what can predict, now or at an earlier moment.
struct EnginesQuestion {
  std::string entity;
  Duration ahead;
  std::optional<Time> at;

  [[nodiscard]] std::string text() const;
};
std::vector<EnginesQuestion> engines_questions();

/// Queries for a memory that prefers latents.
std::vector<std::string> latent_questions();

}  // namespace engram::testing
