// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/evaluate.h"
#include "training/metrics.h"

// Private to this room.

namespace engram::training {

/// Collects errors of both kinds.
///
/// Threading: one thread.
struct QualitySums {
  PsnrStatistics psnr;
  RmseStatistics rmse;

  void add(const ltm::MeasuredError& error);
  void add(const QualitySums& more);
  [[nodiscard]] Quality quality() const;
};

}  // namespace engram::training
