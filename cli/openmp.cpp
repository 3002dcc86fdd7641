// SPDX-License-Identifier: Apache-2.0
#include "cli/openmp.h"

#include <stdlib.h>
#include <unistd.h>

namespace engram::cli {

namespace {

/// Some ten microseconds: longer than the gaps within a layer, shorter than a scheduler's slice.
constexpr const char* kSpins = "10000";

}  // namespace

void rest_waiting_threads(char** argv) {
  if (::getenv("OMP_WAIT_POLICY") != nullptr || ::getenv("GOMP_SPINCOUNT") != nullptr) return;
  ::setenv("GOMP_SPINCOUNT", kSpins, 1);
  ::execv("/proc/self/exe", argv);
  // Where that is not possible, waiting threads spin: slower, not wrong.
}

}  // namespace engram::cli
