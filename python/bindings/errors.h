// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "ltm/core/status.h"

namespace engram::python {

/// Raises the exception of engram.errors that belongs to the status code. Needs an error status and
/// the GIL.
[[noreturn]] void raise(const Status& status);

/// Returns the value, or raises the error as raise() does.
template <typename T>
T value_or_raise(Result<T> result) {
  if (!result.ok()) raise(result.status());
  return std::move(result).value();
}

}  // namespace engram::python
