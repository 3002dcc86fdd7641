// SPDX-License-Identifier: Apache-2.0
#pragma once

// LibTorch for the sources of this repository that need it. Costs 16 s per translation unit where
// it is not precompiled: no public header includes this.
#include <torch/torch.h>

#include <string>

#include "ltm/core/status.h"

namespace engram::encoders {

/// Runs `work`, which returns a Status or a Result, and turns what LibTorch throws into a Status.
template <typename Work>
auto guarded(std::string_view what, Work work) -> decltype(work()) {
  try {
    return work();
  } catch (const c10::Error& error) {
    return Status(StatusCode::kUnavailable,
                  std::string(what) + ": LibTorch: " + error.what_without_backtrace());
  } catch (const std::bad_alloc&) {
    return Status(StatusCode::kResourceExhausted, std::string(what) + ": out of memory");
  } catch (const std::exception& error) {
    return Status(StatusCode::kUnavailable, std::string(what) + ": LibTorch: " + error.what());
  }
}

}  // namespace engram::encoders
