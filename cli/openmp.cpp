// SPDX-License-Identifier: Apache-2.0
#include "cli/openmp.h"

#include <stdlib.h>
#include <unistd.h>

namespace engram::cli {

void rest_waiting_threads(char** argv) {
  if (::getenv("OMP_WAIT_POLICY") != nullptr || ::getenv("GOMP_SPINCOUNT") != nullptr) return;
  ::setenv("OMP_WAIT_POLICY", "passive", 1);
  ::execv("/proc/self/exe", argv);
  // Where that is not possible, waiting threads spin: slower, not wrong.
}

}  // namespace engram::cli
