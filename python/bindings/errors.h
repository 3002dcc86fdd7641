// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "ltm/core/status.h"

namespace engram::python {

/// Raises the class of engram.errors that belongs to the code. Needs an error, and the GIL.
[[noreturn]] void raise(const Status& status);

/// The value, or what raise() does.
template <typename T>
T value_or_raise(Result<T> result) {
  if (!result.ok()) raise(result.status());
  return std::move(result).value();
}

}  // namespace engram::python
