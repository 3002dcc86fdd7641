// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/idf/type.h"
#include "ltm/memory/source.h"

namespace engram::memory {

/// How far a predicted value is from what came: the error that predictions tell beforehand
/// (docs/prediction.md), over the members that count in errors. NaN for a kind of member that the
/// value does not have. Images and large arrays are compared at up to 16,384 places each.
/// `type`: that of the entity's segment, if it has one.
/// Errors: kInvalidArgument if the two have different layouts.
Result<ltm::MeasuredError> prediction_error(const idf::Data& predicted, const idf::Data& came,
                                            const std::optional<idf::Type>& type);

}  // namespace engram::memory
