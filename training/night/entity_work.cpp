// SPDX-License-Identifier: Apache-2.0
#include "training/night/entity_work.h"

#include "ltm/core/check.h"

namespace engram::training {

std::optional<Skipped> skipped_by(const Status& error, const JobPace& pace) {
  ENGRAM_CHECK(!error.ok(), "a step that succeeded skips nothing");
  if (pace.is_time_over()) return Skipped{error.message(), true};
  if (error.code() == StatusCode::kInvalidArgument) return Skipped{error.message(), false};
  return std::nullopt;
}

Skipped nothing_encoded() {
  return {"the time was over before anything was encoded", true};
}

}  // namespace engram::training
