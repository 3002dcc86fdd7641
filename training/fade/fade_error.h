// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/store/latent.h"

// Private to this room.

namespace engram::training {

/// How much the errors of two steps of coding are expected to have in common at most: their
/// correlation. `make fade-bars` measures 0.11 at most, and about 0 in the mean.
/// Source: experiments/learning/LOG.md, "fading".
inline constexpr double kMaxErrorCorrelation = 0.3;

/// The largest error of coding again a value that has the error `before_mse`, so that both together
/// are expected to be within `target_mse`; 0 if there is none. All are mean squared errors in grey
/// levels squared.
[[nodiscard]] double max_step_mse(double before_mse, double target_mse);

/// How good a value is that was coded again with the error `step`. `before` is its quality until
/// then; nothing if it was recorded, and then `step` is all of the error.
///
/// Else the error is estimated as that of two independent steps, and bounded by the triangle
/// inequality. All are rounded up by 0.4 % at most: a store keeps them of every snapshot, and
/// digits that mean nothing would take as many bytes as a gist.
[[nodiscard]] ltm::LatentQuality joined_quality(const std::optional<ltm::LatentQuality>& before,
                                                const ltm::MeasuredError& step, float faded_to_db);

}  // namespace engram::training
