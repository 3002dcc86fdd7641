// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/measure/evaluate.h"

namespace engram::reports {

/// Prints tables of bytes, access times, errors of reconstructions and predictions, and the
/// coverage of bounds.
void print_evaluation(const training::EntityEvaluation& entity);

}  // namespace engram::reports
