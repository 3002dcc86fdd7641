// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <set>
#include <stop_token>

#include "encoders/deep_model.h"
#include "training/fit/training_source.h"

// Private to this room: includes LibTorch.

namespace engram::training {

/// A copy of a model that knows no content (learned_from.h), without some references.
/// Errors: those of reading the file.
Result<std::shared_ptr<encoders::DeepModel>> without_references(const std::filesystem::path& file,
                                                                const std::set<uint64_t>& gone);

/// A model without networks, fitted to values. It keeps every bit of numbers, because they were
/// rounded before. There must be at least one value (checked).
/// Errors: those of source.read; kCancelled on a stop.
Result<std::shared_ptr<encoders::DeepModel>> fitted_without_networks(TrainingSource source,
                                                                     const std::stop_token& stop);

}  // namespace engram::training
