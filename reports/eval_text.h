// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/measure/evaluate.h"

namespace engram::reports {

/// Bytes, access times, errors of reconstructions and predictions, and what bounds were worth, as
/// tables.
void print_evaluation(const training::EntityEvaluation& entity);

}  // namespace engram::reports
