// SPDX-License-Identifier: Apache-2.0
#pragma once

// Includes LibTorch. This costs 16 s per translation unit that does not precompile it, so no public
// header includes this one.
#include <torch/torch.h>

#include <string>

#include "ltm/core/status.h"

namespace engram::encoders {

/// Runs `work`, which returns a Status or a Result, and turns exceptions of LibTorch into a Status.
/// Errors: kUnavailable; kResourceExhausted without memory; the errors of `work`.
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
